// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/files/cloud_file.h>

#include <pcl/PCLPointCloud2.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The points of a table as PCL's cloud with fields by name, packed. The
 * viewpoint is lost: such a cloud has none.
 * \throws InvalidParameterException if data and fields do not fit, or there are more
 * points than PCL can index */
void toPCLPointCloud2(const PcdTable& table, pcl::PCLPointCloud2& cloud);

/** \brief Likewise back. Padding (fields called `_`, gaps between fields) is dropped.
 * \throws InvalidParameterException if sizes, fields or names do not fit, or the bytes
 * are big-endian */
void fromPCLPointCloud2(const pcl::PCLPointCloud2& cloud, PcdTable& table);

/** \brief A voxel cloud with all that it holds, voxel by voxel: x y z rgba label,
 * probability (COUNT L, refined), measured (COUNT L), observations, index (COUNT 3),
 * voxel_size [m] and origin (COUNT 3, world frame [m]).
 * \throws InvalidParameterException if its arrays differ in length */
void toPCLPointCloud2(const VoxelCloud& voxels, pcl::PCLPointCloud2& cloud);

/** \brief Likewise back, also of a part of the voxels, as filters leave them. Without
 * voxels nothing says their size: it is then 0.
 * \throws InvalidParameterException if a field is missing */
void fromPCLPointCloud2(const pcl::PCLPointCloud2& cloud, VoxelCloud& voxels);

} // namespace pcl_semantic
