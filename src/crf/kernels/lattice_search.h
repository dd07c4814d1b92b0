// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

/** \brief The inner loop that looks for vertices of a lattice by their keys. */
namespace pcl_semantic::kernels {

/** \brief A table of keys with open addressing, of a power of two of slots. A slot is 0
 * (free) or holds the number of a key + 1 in its lower bits and a part of the hash
 * above them. */
struct LatticeTableView {
  const std::uint32_t* slots;
  const std::uint64_t* keys; ///< by number
  int shift;                 ///< from a hash to its slot
  std::uint32_t number_mask; ///< the lower bits of a slot
};

/** \brief Of a key that is not in the slot where it is looked for first. */
constexpr std::int32_t not_first = -2;

constexpr std::uint64_t key_factors[2] = {0x9E3779B97F4A7C15u, 0xBF58476D1CE4E5B9u};

/** \brief Mixes all bits of a key into the upper ones, and those into the lower. */
inline std::uint64_t
mixKey(std::uint64_t key)
{
  key *= key_factors[0];
  return (key ^ (key >> 32)) * key_factors[1];
}

/** \brief Looks for keys where they are looked for first, without a branch: many at a
 * time. \param[out] numbers -1 if they are unknown, not_first if another key is there
 */
using LatticeSearch = void (*)(const LatticeTableView& table, const std::uint64_t* keys,
                               std::size_t count, std::int32_t* numbers);

/** \brief The loop for a tier. All give the same numbers. */
LatticeSearch latticeSearch(SimdTier tier);

} // namespace pcl_semantic::kernels
