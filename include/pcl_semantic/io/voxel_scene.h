/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_cloud.h>

#include <cstdint>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The cubes that the points of a cloud fill. */
struct VoxelGrid {
  double size = 0.0; ///< edge of a cube [m]; 0 = not known
  Eigen::Vector3d corner = Eigen::Vector3d::Zero(); ///< lower corner of cube 0 [m]
};

/** \brief Any labelled cloud as voxels to draw. */
struct VoxelScene {
  /** \brief Indices of the cubes in \a grid; labels and colours in the cloud; refined
   * distributions if there are any. Its origin is the grid's corner. */
  VoxelCloud voxels;
  std::vector<std::uint32_t> cliques; ///< 0 = none; empty if the file has no such field
  bool has_colour = false;
  bool has_labels = false;
  VoxelGrid grid;
};

/** \brief Reads a `.pcd` as readLabelledCloud() does; points that are not finite are
 * left out.
 *
 * Several points of a voxel become one: the most frequent label (the lowest of equals),
 * the mean colour, and clique and distribution of the first point of that label.
 * \param[in] grid size 0: it is found from the points, which have to lie at the centres
 * of the cubes then, as those of a written map do
 * \throws BadInputException as readLabelledCloud(), if there is no point, or no grid */
VoxelScene readVoxelScene(const std::string& path, const VoxelGrid& grid = {});

/** \brief The same for voxels in memory, of an archive for example. */
VoxelScene sceneOf(VoxelCloud voxels);

/** \brief The labels of \a other at the voxels of \a scene; 0 where it has none.
 * \param[in] other of the same grid
 * \throws InvalidParameterException if it is of another */
std::vector<Label> labelsAtVoxels(const VoxelScene& scene, const VoxelScene& other);

} // namespace pcl_semantic
