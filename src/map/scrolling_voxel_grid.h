// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/fail.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/voxel_index.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <utility>
#include <vector>

namespace pcl_semantic {

/** \brief A window of blocks that moves through an unbounded grid without copying: a
 * block keeps its slot in a ring buffer while it is inside. */
template <typename Block> class ScrollingVoxelGrid {
public:
  using BlockIndex = Eigen::Vector3i;

  /** \param[in] size window in blocks, each axis positive
   * \throws InvalidParameterException if the ring would have more than 2^28 slots */
  explicit ScrollingVoxelGrid(const Eigen::Vector3i& size) : size_(size)
  {
    const double slots = size.cast<double>().prod();
    if ((size.array() <= 0).any() || slots > double(1 << 28))
      badParameter("a window of ", size.transpose(),
                   " blocks is empty or too large; take a "
                   "smaller window or larger voxels");
    blocks_.resize(static_cast<std::size_t>(slots));
  }

  const Eigen::Vector3i&
  size() const
  {
    return size_;
  }

  /** \brief The smallest block index inside the window. Before the first scrollTo() the
   * window contains no valid block index. */
  const BlockIndex&
  origin() const
  {
    return origin_;
  }

  bool
  contains(const BlockIndex& block) const
  {
    const Eigen::Array3i offset = (block - origin_).array();
    return (offset >= 0).all() && (offset < size_.array()).all();
  }

  std::size_t
  slots() const
  {
    return blocks_.size();
  }

  std::size_t
  slotOf(const BlockIndex& block) const
  {
    const std::size_t x = wrap(block.x(), size_.x());
    const std::size_t y = wrap(block.y(), size_.y());
    const std::size_t z = wrap(block.z(), size_.z());
    return (z * std::size_t(size_.y()) + y) * std::size_t(size_.x()) + x;
  }

  std::unique_ptr<Block>&
  at(std::size_t slot)
  {
    return blocks_[slot];
  }

  /** \brief The block at an index, null if there is none or it is outside. */
  Block*
  find(const BlockIndex& block) const
  {
    return contains(block) ? blocks_[slotOf(block)].get() : nullptr;
  }

  /** \brief Moves the window so that its smallest block is \a origin; the cost is
   * proportional to the blocks that leave and enter. If a callback throws, the window
   * stays.
   * \param[in] leave called with (index, block) for each block that leaves
   * \param[in] enter called with (index) for each position that enters; returns its
   * block or null */
  template <typename Leave, typename Enter>
  void scrollTo(const BlockIndex& origin, Leave&& leave, Enter&& enter);

  /** \brief Calls \a visit(index, slot) for every position of the window, in the order
   * z, y, x of the indices. */
  template <typename Visit>
  void
  forEachSlot(Visit&& visit) const
  {
    forEachIn(origin_, size_, visit);
  }

  /** \brief Calls \a visit(index, block) for every block of the window, in the order of
   * forEachSlot(). */
  template <typename Visit>
  void
  forEach(Visit&& visit) const
  {
    forEachSlot([&](const BlockIndex& block, std::size_t slot) {
      if (blocks_[slot])
        visit(block, *blocks_[slot]);
    });
  }

private:
  // So far from kMaxVoxelIndex / 8 that the first scrollTo() does not overlap.
  static constexpr int nowhere = -kMaxVoxelIndex;

  static std::size_t
  wrap(int value, int size)
  {
    const int rest = value % size;
    return static_cast<std::size_t>(rest < 0 ? rest + size : rest);
  }

  // Visits a box no larger than the window, as forEachSlot() does.
  template <typename Visit>
  void forEachIn(const BlockIndex& first, const BlockIndex& extent,
                 Visit&& visit) const;

  // Visits the window at one origin, except for its overlap with that at another.
  template <typename Visit>
  void forEachOutside(const BlockIndex& origin, const BlockIndex& other,
                      Visit&& visit) const;

  Eigen::Vector3i size_;
  BlockIndex origin_ = BlockIndex::Constant(nowhere);
  std::vector<std::unique_ptr<Block>> blocks_;
};

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
  // Nothing throws from here on.
  forEachOutside(origin_, origin,
                 [&](const BlockIndex&, std::size_t slot) { blocks_[slot].reset(); });
  origin_ = origin;
  for (auto& [slot, content] : entering)
    blocks_[slot] = std::move(content);
}

// Splits the outside into boxes: along x; of the rest along y; of the rest along z.
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
