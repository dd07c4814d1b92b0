// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/map/scrolling_voxel_grid.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace pcl_semantic {

template <typename Block>
template <typename Leave, typename Enter>
void
ScrollingVoxelGrid<Block>::scrollTo(const BlockIndex& origin, Leave&& leave,
                                    Enter&& enter)
{
  forEachOutside(origin_, origin, [&](const BlockIndex& block, std::size_t slot) {
    if (blocks_[slot])
      leave(block, *blocks_[slot]);
  });
  std::vector<std::pair<std::size_t, std::unique_ptr<Block>>> entering;
  forEachOutside(origin, origin_, [&](const BlockIndex& block, std::size_t slot) {
    if (std::unique_ptr<Block> content = enter(block))
      entering.emplace_back(slot, std::move(content));
  });
  // From here on nothing fails.
  forEachOutside(origin_, origin,
                 [&](const BlockIndex&, std::size_t slot) { blocks_[slot].reset(); });
  origin_ = origin;
  for (auto& [slot, content] : entering)
    blocks_[slot] = std::move(content);
}

// The part outside falls into boxes: what is outside along x; of the rest, what is
// outside along y; of the rest of that, along z.
template <typename Block>
template <typename Visit>
void
ScrollingVoxelGrid<Block>::forEachOutside(const BlockIndex& origin,
                                          const BlockIndex& other, Visit&& visit) const
{
  BlockIndex first = origin, extent = size_;
  for (int axis = 0; axis < 3; ++axis) {
    const int shift = origin[axis] - other[axis];
    const int outside = std::min(std::abs(shift), size_[axis]);
    BlockIndex box_first = first, box_extent = extent;
    box_extent[axis] = outside;
    if (shift > 0)
      box_first[axis] += size_[axis] - outside;
    forEachIn(box_first, box_extent, visit);
    extent[axis] -= outside;
    if (shift < 0)
      first[axis] += outside;
  }
}

template <typename Block>
template <typename Visit>
void
ScrollingVoxelGrid<Block>::forEachIn(const BlockIndex& first, const BlockIndex& extent,
                                     Visit&& visit) const
{
  for (int z = 0; z < extent.z(); ++z)
    for (int y = 0; y < extent.y(); ++y) {
      std::size_t column = wrap(first.x(), size_.x());
      const std::size_t row = slotOf(first + BlockIndex(0, y, z)) - column;
      for (int x = 0; x < extent.x(); ++x) {
        visit(BlockIndex(first + BlockIndex(x, y, z)), row + column);
        column = column + 1 == std::size_t(size_.x()) ? 0 : column + 1;
      }
    }
}

} // namespace pcl_semantic
