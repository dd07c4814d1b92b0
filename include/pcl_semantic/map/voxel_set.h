// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_index.h>

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A set of voxels, one bit each, for fast neighbour queries (millions per
 * second). */
class VoxelSet {
  using Bits = std::array<std::uint64_t, 8>; // 8 x 8 x 8 voxels, one word per layer

public:
  explicit VoxelSet(const std::vector<VoxelIndex>& voxels);

  std::size_t
  size() const
  {
    return size_;
  }

  /** \brief Queries a set and caches the last block; use one reader per thread. The set
   * must outlive the reader. */
  class Reader {
  public:
    explicit Reader(const VoxelSet& set) : set_(set) {}

    bool
    contains(const VoxelIndex& voxel)
    {
      const VoxelIndex block(voxel.x() >> 3, voxel.y() >> 3, voxel.z() >> 3);
      if (block != block_ || !asked_) {
        const auto found = set_.blocks_.find(block);
        bits_ = found == set_.blocks_.end() ? nullptr : &found->second;
        block_ = block;
        asked_ = true;
      }
      return bits_ && ((*bits_)[voxel.z() & 7] >> bitOf(voxel) & 1);
    }

  private:
    const VoxelSet& set_;
    VoxelIndex block_ = VoxelIndex::Zero();
    const Bits* bits_ = nullptr;
    bool asked_ = false;
  };

private:
  static int
  bitOf(const VoxelIndex& voxel)
  {
    return (voxel.y() & 7) * 8 + (voxel.x() & 7);
  }

  std::unordered_map<VoxelIndex, Bits, VoxelIndexHash> blocks_;
  std::size_t size_ = 0;
};

} // namespace pcl_semantic
