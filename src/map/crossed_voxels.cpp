// SPDX-License-Identifier: BSD-3-Clause
#include "crossed_voxels.h"

#include <algorithm>

namespace pcl_semantic {

void
CrossedVoxels::begin(const Grid& grid)
{
  // Bits are stored by slot, so they stay valid if the window has moved.
  for (std::size_t slot = 0; slot < touched_.size(); ++slot)
    if (touched_[slot]) {
      std::fill_n(bits_.begin() + long(slot * kWords), kWords, 0);
      touched_[slot] = 0;
    }
  first_ = grid.origin();
  const std::size_t corner = grid.slotOf(first_);
  for (int axis = 0; axis < 3; ++axis) {
    parts_[axis].resize(std::size_t(grid.size()[axis]));
    VoxelIndex block = first_;
    for (std::size_t& part : parts_[axis]) {
      // Unsigned differences may wrap, and so does their sum.
      part = grid.slotOf(block) - (axis == 0 ? 0 : corner);
      ++block[axis];
    }
  }
}

std::vector<VoxelIndex>
CrossedVoxels::blocks() const
{
  std::vector<VoxelIndex> blocks;
  for (int z = first_.z(); z <= lastBlock(2); ++z)
    for (int y = first_.y(); y <= lastBlock(1); ++y) {
      VoxelIndex block(first_.x(), y, z);
      const std::uint8_t* const row = touched_.data() + slotOf(block) - parts_[0][0];
      for (const std::size_t part : parts_[0]) {
        if (row[part])
          blocks.push_back(block);
        ++block.x();
      }
    }
  return blocks;
}

} // namespace pcl_semantic
