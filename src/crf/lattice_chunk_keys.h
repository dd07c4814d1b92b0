// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief Keys are sorted into partitions by bits of their hash, for the threads. */
constexpr int partition_bits = 6;
constexpr std::size_t partitions = 1 << partition_bits;

/** \brief The keys that a chunk touches, numbered in the order of the first touch. */
template <typename Key> struct ChunkKeys {
  std::vector<Key> keys;                // sorted by partition
  std::vector<std::uint32_t> places;    // of each number among the sorted
  std::uint32_t begins[partitions + 1]; // of the partitions
  std::size_t first = 0;                // keys of earlier chunks
};

} // namespace pcl_semantic
