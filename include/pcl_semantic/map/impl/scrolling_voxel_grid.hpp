/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

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
  for (int axis = 0; axis < 3; ++axis) {
    const int shift = origin[axis] - origin_[axis];
    if (shift == 0)
      continue;
    const int thickness = std::min(std::abs(shift), size_[axis]);
    BlockIndex slab = origin_;
    slab[axis] += shift > 0 ? 0 : size_[axis] - thickness;
    forEachInSlab(slab, axis, thickness,
                  [&](const BlockIndex& block, std::size_t slot) {
                    if (blocks_[slot])
                      leave(block, std::move(blocks_[slot]));
                  });
    origin_[axis] = origin[axis];
    slab[axis] = origin[axis] + (shift > 0 ? size_[axis] - thickness : 0);
    // What enters now may leave again along a later axis: wait until it is certain.
    forEachInSlab(slab, axis, thickness,
                  [&](const BlockIndex& block, std::size_t slot) {
                    bool stays = true;
                    for (int later = axis + 1; later < 3; ++later)
                      stays &= block[later] >= origin[later] &&
                               block[later] < origin[later] + size_[later];
                    if (stays)
                      blocks_[slot] = enter(block);
                  });
  }
}

template <typename Block>
template <typename Visit>
void
ScrollingVoxelGrid<Block>::forEachInSlab(const BlockIndex& first, int axis,
                                         int thickness, Visit&& visit) const
{
  BlockIndex extent = size_;
  extent[axis] = thickness;
  for (int z = 0; z < extent.z(); ++z)
    for (int y = 0; y < extent.y(); ++y) {
      const std::size_t row =
          slotOf(first + BlockIndex(0, y, z)) - wrap(first.x(), size_.x());
      std::size_t column = wrap(first.x(), size_.x());
      for (int x = 0; x < extent.x(); ++x) {
        visit(BlockIndex(first + BlockIndex(x, y, z)), row + column);
        column = column + 1 == std::size_t(size_.x()) ? 0 : column + 1;
      }
    }
}

} // namespace pcl_semantic
