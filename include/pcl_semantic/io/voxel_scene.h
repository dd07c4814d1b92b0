// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/map/semantic_voxel_map.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The cubes that the points of a cloud fill. */
struct VoxelGrid {
  double size = 0.0; ///< edge of a cube [m]; 0 = not known
  Eigen::Vector3d corner = Eigen::Vector3d::Zero(); ///< lower corner of cube 0 [m]
};

/** \brief Any labelled cloud as voxels to draw, or to write in other forms. */
struct VoxelScene {
  /** \brief Indices of the cubes in \a grid; labels and colours in the cloud; refined
   * distributions if there are any. Its origin is the grid's corner. */
  VoxelCloud voxels;
  bool has_colour = false;
  bool has_labels = false;
  VoxelGrid grid;
  /// Where the zero of the points is, world frame [m]; 0 if the file does not say it.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  /// Voxels that are known to be empty. A cloud knows only what is occupied.
  std::vector<VoxelIndex> free;
  bool knows_free = false;         ///< all others are unknown then
  std::vector<std::string> doubts; ///< PcdTable::doubts of the file
};

/** \brief Centre of a cube in the frame of the points [m]. */
inline Eigen::Vector3d
centreOf(const VoxelGrid& grid, const VoxelIndex& voxel)
{
  return grid.corner + centreOf(voxel, grid.size);
}

/** \brief Reads a `.pcd` as readLabelledCloud() does; points that are not finite are
 * left out, and so are two or more at exactly 0 0 0 (countNoReturns()).
 *
 * Several points of a voxel become one: the most frequent label (the lowest of equals),
 * the mean colour, and the distribution of the first point of that label.
 * \param[in] grid size 0: the file says it, as that of a written map does, or it is
 * found from the points, which have to lie at the centres of the cubes then; of no
 * points it stays 0
 * \param[in] otherwise the grid if the file says none; size 0: it is found
 * \throws BadInputException as readLabelledCloud(), or if there is no grid */
VoxelScene readVoxelScene(const std::string& path, const VoxelGrid& grid = {},
                          const VoxelGrid& otherwise = {});

/** \brief All occupied voxels of a map in memory, of an archive for example; their
 * indices are those of the map.
 * \param[in] with_free also those that rays have only passed through */
VoxelScene sceneOf(const SemanticVoxelMap& map, bool with_free = false);

/** \brief The labels of \a other at the voxels of \a scene; 0 where it has none.
 * \param[in] other of the same grid in the world; its origin may be another
 * \throws InvalidParameterException if it is of another */
std::vector<Label> labelsAtVoxels(const VoxelScene& scene, const VoxelScene& other);

} // namespace pcl_semantic
