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

/** \brief A set of block indices: one bit per position in non-empty cubes of 16 x 16 x
 * 16 blocks. A scrolling window queries thousands of positions without a block; this
 * answers without disk access. */
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
    key_sum_ += VoxelIndexHash()(block) + 1; // independent of the order
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

  /** \brief Sum of a hash of the indices, modulo 2^64: a checksum of the set. */
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

/** \brief Requires that a value was read to its end. \throws BadInputException */
void requireEnd(const ByteReader& reader);

/** \brief Reads the header of a map. \throws BadInputException */
ArchiveHeader readHeader(ArchiveDatabase& database);

void writeHeader(ArchiveDatabase& database, const ArchiveHeader& header);

/** \throws BadInputException */
ArchiveState readState(ArchiveDatabase& database);

void writeState(ArchiveDatabase& database, const ArchiveState& state);

/** \brief Reads the block indices and compares them with those of the last commit.
 * Otherwise a block whose row is lost would look like one that never existed.
 * \throws BadInputException */
BlockIndexSet readBlockKeys(ArchiveDatabase& database, const ArchiveState& state);

/** \brief Checks that blocks are those of the last commit.
 * \throws BadInputException */
void checkBlockKeys(const std::string& path, const BlockIndexSet& blocks,
                    const ArchiveState& state);

/** \brief Checks that the number of frames is that of the last commit.
 * \throws BadInputException */
void checkFrameCount(ArchiveDatabase& database, const ArchiveState& state);

} // namespace pcl_semantic
