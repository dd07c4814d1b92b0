// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_index.h>

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Of pcl::SupervoxelClustering, with its defaults for the weights. */
struct SupervoxelParameters {
  double seed_resolution = 0.8;  ///< distance from supervoxel to supervoxel [m]
  double voxel_resolution = 0.1; ///< points in a cube of this edge are one voxel [m]
  bool fixed_cubes = false; ///< the cubes of the clustering begin at the origin, not at
                            ///< the cloud: for clouds that grow or scroll

  /** \throws InvalidParameterException that names the parameter and its range */
  void validate() const;
};

/** \brief Supervoxels as cliques: groups of points that lie together, look alike and
 * face one way (Papon et al. 2013, pcl::SupervoxelClustering). They need the cloud
 * alone, of any sensor; points without colour are grouped without.
 *
 * Each finite point is in one clique or in none. The clustering runs by itself in each
 * cube of a grid of about eight seeds' width, which no supervoxel leaves. The lowest
 * coordinates lie in the middle of the grid's first voxel, so that a cloud may lie
 * anywhere. The clustering gets the cube's points in an order of its own, so that
 * neither their order nor the number of threads matters. Points it leaves out go to the
 * supervoxel of the nearest point that it did not, if that is within seed_resolution
 * and in the cube.
 *
 * A call takes over the cubes that have not changed since the last one, bit by bit: the
 * result is that of a new object, and costs what has changed. Clouds whose lowest
 * coordinates change need SupervoxelParameters::fixed_cubes for that. */
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

  /** \brief Groups the points; cliques in the order of their first points.
   * \throws BadInputException that names the point, if one is more than kMaxVoxelIndex
   * cubes from where the grid begins */
  std::vector<pcl::PointIndices> generate(const Cloud& cloud) override;

  /** \brief Cubes of the last generate(), and those of them that had changed. */
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
    std::vector<Point> points;         ///< in their order
    std::vector<std::uint32_t> labels; ///< of their supervoxels, from 1; 0 = none
  };

  using Cubes = std::unordered_map<VoxelIndex, Cube, VoxelIndexHash>;

  /** \brief A cube's points and where they are in the cloud. */
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
