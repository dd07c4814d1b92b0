// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_index.h>

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Parameters of pcl::SupervoxelClustering. Its weights of colour, position and
 * normal keep their defaults. */
struct SupervoxelParameters {
  double seed_resolution = 0.8;  ///< distance between supervoxel seeds [m]
  double voxel_resolution = 0.1; ///< points in a cube of this edge are one voxel [m]
  /// The grid of cubes begins at the origin instead of at the lowest coordinates of the
  /// cloud. Use it for clouds that grow or scroll.
  bool fixed_cubes = false;

  /** \throws InvalidParameterException that names the parameter and its range */
  void validate() const;
};

/** \brief Supervoxels as cliques: groups of adjacent points with similar colour and
 * normal (Papon et al. 2013, pcl::SupervoxelClustering). Clouds of any sensor are
 * suitable. Colours are optional.
 *
 * The clustering runs separately in each cube of a grid, and a supervoxel never extends
 * into another cube. Cubes are about eight seeds wide. Unless
 * SupervoxelParameters::fixed_cubes is set, the grid begins half a voxel below the
 * lowest coordinates of the cloud. A cloud may therefore lie anywhere. Points are
 * sorted before clustering, so the result depends neither on their order nor on the
 * number of threads.
 *
 * Each finite point is in at most one clique. Points that the clustering omits join the
 * supervoxel of the nearest clustered point within seed_resolution in the same cube.
 *
 * generate() clusters only the cubes that have changed since its previous call. The
 * result is the same as without a previous call. If the lowest coordinates change, all
 * cubes change, unless SupervoxelParameters::fixed_cubes is set. */
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

  /** \brief Groups the points.
   * \return cliques in the order of their first points
   * \throws BadInputException that names the point, if a point is too far from the
   * origin of the grid (more than kMaxVoxelIndex cubes) */
  std::vector<pcl::PointIndices> generate(const Cloud& cloud) override;

  /** \brief Number of cubes of the last generate(). */
  std::size_t
  cubes() const
  {
    return cubes_.size();
  }

  /** \brief Number of cubes that the last generate() had to cluster. */
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
