// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/voxel_index.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief Finds the index of a voxel in a list; for duplicates, the first. Open
 * addressing: built many times faster than a std::unordered_map. */
class VoxelTable {
public:
  /** \param[in] voxels fewer than 2^31; they must outlive the table */
  explicit VoxelTable(const std::vector<VoxelIndex>& voxels) : voxels_(voxels)
  {
    std::size_t slots = 16;
    while (slots < 2 * voxels.size())
      slots *= 2;
    mask_ = slots - 1;
    slots_.resize(slots, kNone);
    for (std::size_t i = 0; i < voxels.size(); ++i)
      if (std::int32_t& slot = slots_[slotOf(voxels[i])]; slot == kNone)
        slot = std::int32_t(i);
      else
        has_twins_ = true;
  }

  /** \return kNone if it is missing */
  std::int32_t
  find(const VoxelIndex& voxel) const
  {
    return slots_[slotOf(voxel)];
  }

  bool
  hasTwins() const
  {
    return has_twins_;
  }

  static constexpr std::int32_t kNone = -1;

private:
  // Slot of the voxel, or the free slot for it.
  std::size_t
  slotOf(const VoxelIndex& voxel) const
  {
    std::size_t slot = VoxelIndexHash()(voxel) & mask_;
    while (slots_[slot] != kNone && voxels_[std::size_t(slots_[slot])] != voxel)
      slot = (slot + 1) & mask_;
    return slot;
  }

  const std::vector<VoxelIndex>& voxels_;
  std::vector<std::int32_t> slots_;
  std::size_t mask_ = 0;
  bool has_twins_ = false;
};

} // namespace pcl_semantic
