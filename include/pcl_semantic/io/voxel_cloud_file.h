/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/voxel_cloud.h>

#include <string>

namespace pcl_semantic {

/** \brief What the field `rgba` of a written map shows. */
enum class VoxelColour {
  measured, ///< mean colour of the pixels
  classes   ///< colour of the class, for pcl_viewer
};

/** \brief Writes a voxel cloud as binary `.pcd`: fields x y z [m, relative to
 * VoxelCloud::origin] rgba label probability (COUNT L, refined) entropy [nat]
 * observations.
 * \throws OutputException */
void writeVoxelCloud(const std::string& path, const VoxelCloud& voxels,
                     const LabelSet& label_set, VoxelColour colour);

} // namespace pcl_semantic
