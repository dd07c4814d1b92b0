// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/map/semantic_voxel_map.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The voxel grid of a cloud. */
struct VoxelGrid {
  double size = 0.0; ///< edge of a voxel [m]; 0 = unknown
  Eigen::Vector3d corner = Eigen::Vector3d::Zero(); ///< lower corner of voxel 0 [m]
};

/** \brief Any labelled cloud as voxels, for rendering or export. */
struct VoxelScene {
  /** \brief Indices in \a grid, labels and colours in the cloud, refined distributions
   * if available. Its origin is the grid's corner. */
  VoxelCloud voxels;
  bool has_colour = false;
  bool has_labels = false;
  VoxelGrid grid;
  /// Origin of the points, world frame [m]; 0 if the file does not contain it.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  /// Free voxels; a scene of a cloud has none.
  std::vector<VoxelIndex> free;
  bool knows_free = false;         ///< false: \a free is unavailable; true: all other
                                   ///< voxels are unknown
  std::vector<std::string> doubts; ///< PcdTable::doubts of the file
};

/** \brief Centre of a voxel in the frame of the points [m]. */
inline Eigen::Vector3d
centreOf(const VoxelGrid& grid, const VoxelIndex& voxel)
{
  return grid.corner + centreOf(voxel, grid.size);
}

/** \brief Reads a `.pcd` as readLabelledCloud() does. Non-finite points are left out,
 * and so are two or more at exactly 0 0 0 (countNoReturns()).
 *
 * Several points in a voxel are merged: the most frequent label (the lowest in a tie),
 * the mean colour, and the distribution of the first point with that label.
 * \param[in] grid size 0: taken from the file (written maps contain it) or estimated
 * from the points, which must then be at voxel centres; 0 remains for an empty cloud
 * \param[in] otherwise the grid if the file contains none; size 0: it is estimated
 * \throws BadInputException as readLabelledCloud(), or if there is no grid */
VoxelScene readVoxelScene(const std::string& path, const VoxelGrid& grid = {},
                          const VoxelGrid& otherwise = {});

/** \brief All occupied voxels of a map in memory, for example of an archive; their
 * indices are those of the map.
 * \param[in] with_free also includes free voxels */
VoxelScene sceneOf(const SemanticVoxelMap& map, bool with_free = false);

/** \brief The labels of \a other at the voxels of \a scene; 0 where it has none.
 * \param[in] other must have the same world grid; its origin may differ
 * \throws InvalidParameterException if the grids differ */
std::vector<Label> labelsAtVoxels(const VoxelScene& scene, const VoxelScene& other);

} // namespace pcl_semantic
