// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_cloud.h>

#include <pcl/PCLPointCloud2.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Converts a voxel cloud with all its fields: x y z rgba label, probability
 * (COUNT L, refined), measured (COUNT L), observations, index (COUNT 3), voxel_size [m]
 * and origin (COUNT 3, world frame [m]).
 * \throws InvalidParameterException if its arrays differ in length */
void toPCLPointCloud2(const VoxelCloud& voxels, pcl::PCLPointCloud2& cloud);

/** \brief Converts back, also a subset of the voxels, such as a filter's output. The
 * voxel size of an empty cloud is 0.
 * \throws InvalidParameterException if a field is missing
 * \throws BadInputException if the voxels come from two maps (voxel_size and origin
 * differ), or a value is invalid */
void fromPCLPointCloud2(const pcl::PCLPointCloud2& cloud, VoxelCloud& voxels);

} // namespace pcl_semantic
