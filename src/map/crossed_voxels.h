// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scrolling_voxel_grid.h"

#include <pcl_semantic/map/semantic_voxel.h>

#include <array>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief The voxels of a window that the rays of one scan cross, one bit each.
 * Thread-safe; the result does not depend on the order of calls. */
class CrossedVoxels {
public:
  using Grid = ScrollingVoxelGrid<VoxelBlock>;

  /** \brief 64-bit words per block: one for each layer in z. */
  static constexpr std::size_t kWords = kBlockVoxels / 64;

  explicit CrossedVoxels(std::size_t slots) : bits_(slots * kWords), touched_(slots) {}

  /** \brief Clears the previous scan and adopts the current window. */
  void begin(const Grid& grid);

  /** \brief Adds voxels of a block.
   * \param[in] slot see slotOf()
   * \param[in] layer 0..7 in z
   * \param[in] bits of voxel (x, y) at 8 y + x */
  void
  add(std::size_t slot, int layer, std::uint64_t bits)
  {
    std::uint64_t& word = bits_[slot * kWords + std::size_t(layer)];
    if (!(bits & ~__atomic_load_n(&word, __ATOMIC_RELAXED)))
      return;
    __atomic_fetch_or(&word, bits, __ATOMIC_RELAXED);
    __atomic_store_n(&touched_[slot], std::uint8_t(1), __ATOMIC_RELAXED);
  }

  /** \brief Adds a voxel; returns false outside the window. */
  bool
  add(const VoxelIndex& voxel)
  {
    const VoxelIndex block = blockOf(voxel);
    if (!contains(block))
      return false;
    const int offset = voxelInBlock(voxel);
    add(slotOf(block), offset >> 6, std::uint64_t(1) << (offset & 63));
    return true;
  }

  int
  firstBlock(int axis) const
  {
    return first_[axis];
  }

  int
  lastBlock(int axis) const
  {
    return first_[axis] + int(parts_[axis].size()) - 1;
  }

  std::size_t
  slotOf(const VoxelIndex& block) const
  {
    std::size_t slot = 0;
    for (int axis = 0; axis < 3; ++axis)
      slot += parts_[axis][std::size_t(block[axis] - first_[axis])];
    return slot;
  }

  bool
  contains(const VoxelIndex& block) const
  {
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis)
      inside &= block[axis] >= first_[axis] && block[axis] <= lastBlock(axis);
    return inside;
  }

  /** \brief The blocks with a crossed voxel, in the order z, y, x. */
  std::vector<VoxelIndex> blocks() const;

  /** \brief The kWords layers in z of a block, see add(). */
  const std::uint64_t*
  layers(std::size_t slot) const
  {
    return bits_.data() + slot * kWords;
  }

  /** \brief Memory [bytes]. */
  std::size_t
  memory() const
  {
    return bits_.capacity() * sizeof(bits_[0]) + touched_.capacity();
  }

private:
  std::vector<std::uint64_t> bits_;               // kWords per slot
  std::vector<std::uint8_t> touched_;             // one byte per slot
  VoxelIndex first_ = VoxelIndex::Zero();         // block of the window
  std::array<std::vector<std::size_t>, 3> parts_; // of a slot, by axis and block
};

} // namespace pcl_semantic
