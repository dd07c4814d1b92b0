// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/map/voxel_set.h>

namespace pcl_semantic {

VoxelSet::VoxelSet(const std::vector<VoxelIndex>& voxels)
{
  Bits* bits = nullptr;
  VoxelIndex last = VoxelIndex::Zero();
  for (const VoxelIndex& voxel : voxels) {
    const VoxelIndex block(voxel.x() >> 3, voxel.y() >> 3, voxel.z() >> 3);
    if (!bits || block != last)
      bits = &blocks_.try_emplace(block, Bits{}).first->second;
    last = block;
    std::uint64_t& layer = (*bits)[voxel.z() & 7];
    const std::uint64_t bit = std::uint64_t(1) << bitOf(voxel);
    size_ += (layer & bit) == 0;
    layer |= bit;
  }
}

} // namespace pcl_semantic
