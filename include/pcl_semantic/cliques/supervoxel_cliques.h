// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_index.h>

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Parameters of pcl::SupervoxelClustering; its weights keep their defaults. */
struct SupervoxelParameters {
  double seed_resolution = 0.8;  ///< distance between supervoxel seeds [m]
  double voxel_resolution = 0.1; ///< points in a cube of this edge are one voxel [m]
  bool fixed_cubes = false; ///< cubes of the clustering begin at the origin instead of
                            ///< at the cloud: for clouds that grow or scroll

  /** \throws InvalidParameterException that names the parameter and its range */
  void validate() const;
};

/** \brief Supervoxels as cliques: groups of adjacent points with similar colour and
 * normal (Papon et al. 2013, pcl::SupervoxelClustering). They need only a cloud, of any
 * sensor; points without colour are grouped without it.
 *
 * Each finite point is in at most one clique. The clustering runs separately in each
 * cube of a grid whose cubes are about eight seeds wide; no supervoxel leaves its cube.
 * The lowest coordinates lie in the middle of the grid's first voxel, so a cloud may
 * lie anywhere. The points of a cube are sorted before clustering, so neither their
 * order nor the number of threads matters. Points that the clustering omits join the
 * supervoxel of the nearest clustered point within seed_resolution in the same cube.
 *
 * A call reuses the cubes that have not changed since the previous call, bit by bit:
 * the result is that of a new object, and the cost depends on the changes. If the
 * lowest coordinates change, this needs SupervoxelParameters::fixed_cubes. */
class SupervoxelCliques : public CliqueGenerator {
public:
  SupervoxelCliques() = default;

  /** \throws InvalidParameterException as SupervoxelParameters::validate() */
  explicit SupervoxelCliques(const SupervoxelParameters& parameters);

  const SupervoxelParameters&
  parameters() const
  {
    return parameters_;
  }

  /** \brief Groups the points; cliques are in the order of their first points.
   * \throws BadInputException that names the point, if one is more than kMaxVoxelIndex
   * cubes from the grid's origin */
  std::vector<pcl::PointIndices> generate(const Cloud& cloud) override;

  /** \brief Number of cubes of the last generate(), and of the changed ones. */
  std::size_t
  cubes() const
  {
    return cubes_.size();
  }

  std::size_t
  changedCubes() const
  {
    return changed_cubes_;
  }

private:
  /** \brief Features of a point for the clustering: position in its cube [m], colour.
   */
  struct Point {
    float x = 0.0f, y = 0.0f, z = 0.0f;
    std::uint32_t rgb = 0;
  };

  struct Cube {
    std::vector<Point> points;
    std::vector<std::uint32_t> labels; ///< supervoxels of the points, from 1; 0 = none
  };

  using Cubes = std::unordered_map<VoxelIndex, Cube, VoxelIndexHash>;

  /** \brief The points of a cube and their indices in the cloud. */
  struct Members {
    VoxelIndex cube = VoxelIndex::Zero();
    std::vector<std::pair<Point, pcl::index_t>> points;
  };

  double cubeEdge() const;
  Eigen::Vector3d cornerOf(const Cloud& cloud) const;
  std::vector<Members> groupByCube(const Cloud& cloud) const;
  Cube cubeOf(Members& members, char& changed) const;
  std::vector<std::uint32_t> cluster(const std::vector<Point>& points) const;

  SupervoxelParameters parameters_;
  Cubes cubes_;
  std::size_t changed_cubes_ = 0;
};

} // namespace pcl_semantic
