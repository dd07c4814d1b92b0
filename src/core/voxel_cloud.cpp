// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/voxel_cloud.h>

#include <algorithm>

namespace pcl_semantic {

bool
hasColour(const VoxelCloud& voxels)
{
  return std::any_of(
      voxels.cloud->begin(), voxels.cloud->end(),
      [](const pcl::PointXYZRGBL& point) { return (point.rgba & 0xFFFFFFu) != 0; });
}

} // namespace pcl_semantic
