// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace pcl_semantic {

/** \brief What a search in a LatticeTable needs, for registers. */
template <typename Key> struct LatticeSlots {
  const std::uint32_t* slots;
  const Key* keys;
  int shift;
  std::uint32_t number_mask;

  std::uint32_t
  entry(std::uint64_t hash, std::size_t number) const
  {
    return (std::uint32_t(hash) & ~number_mask) | std::uint32_t(number);
  }

  // The slot that has a key or is free for it.
  std::size_t
  search(Key key, std::uint64_t hash) const
  {
    const std::uint32_t tag = std::uint32_t(hash) & ~number_mask;
    std::size_t slot = std::size_t(hash >> shift);
    for (;; slot = (slot + 1) & number_mask) {
      const std::uint32_t found = slots[slot];
      if (found == 0 ||
          ((found & ~number_mask) == tag && keys[(found & number_mask) - 1] == key))
        return slot;
    }
  }
};

} // namespace pcl_semantic
