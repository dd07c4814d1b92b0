// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "archive_database.h"

#include <pcl_semantic/core/voxel_index.h>
#include <pcl_semantic/io/map_archive.h>

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

namespace pcl_semantic {

/** \brief Which blocks are there: one bit a position in cubes of 16 x 16 x 16 blocks
 * that hold any. A window that scrolls asks for thousands of positions that no scan has
 * reached; this answers without the disk. */
class BlockIndexSet {
public:
  /** \return whether it is new */
  bool
  insert(const VoxelIndex& block)
  {
    auto bit = tiles_[tileOf(block)][offsetOf(block)];
    if (bit)
      return false;
    bit = true;
    ++size_;
    key_sum_ += VoxelIndexHash()(block) + 1; // a sum knows no order
    return true;
  }

  bool
  contains(const VoxelIndex& block) const
  {
    const auto tile = tiles_.find(tileOf(block));
    return tile != tiles_.end() && tile->second[offsetOf(block)];
  }

  std::uint64_t
  size() const
  {
    return size_;
  }

  /** \brief Sum of a hash of the indices, modulo 2^64: another set has another sum. */
  std::uint64_t
  keySum() const
  {
    return key_sum_;
  }

private:
  static constexpr int bits = 4;
  static constexpr int mask = (1 << bits) - 1;

  static VoxelIndex
  tileOf(const VoxelIndex& block)
  {
    return {block.x() >> bits, block.y() >> bits, block.z() >> bits};
  }

  static std::size_t
  offsetOf(const VoxelIndex& block)
  {
    return std::size_t(((block.z() & mask) << bits | (block.y() & mask)) << bits |
                       (block.x() & mask));
  }

  std::unordered_map<VoxelIndex, std::bitset<1 << (3 * bits)>, VoxelIndexHash> tiles_;
  std::uint64_t size_ = 0;
  std::uint64_t key_sum_ = 0;
};

/** \brief Reads the header of a map. \throws BadInputException */
ArchiveHeader readHeader(ArchiveDatabase& database);

void writeHeader(ArchiveDatabase& database, const ArchiveHeader& header);

/** \throws BadInputException */
ArchiveState readState(ArchiveDatabase& database);

void writeState(ArchiveDatabase& database, const ArchiveState& state);

/** \brief Which blocks there are. A block whose row is lost would look like one that
 * never was: the keys have to be those that were committed, in order.
 * \throws BadInputException */
BlockIndexSet readBlockKeys(ArchiveDatabase& database, const ArchiveState& state);

/** \brief Whether blocks are those that were committed.
 * \throws BadInputException */
void checkBlockKeys(const std::string& path, const BlockIndexSet& blocks,
                    const ArchiveState& state);

/** \brief Whether the frames are as many as were committed.
 * \throws BadInputException */
void checkFrameCount(ArchiveDatabase& database, const ArchiveState& state);

} // namespace pcl_semantic
