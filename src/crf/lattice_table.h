// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"
#include "kernels/lattice_building.h"
#include "lattice_keys.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

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

/** \brief Numbers keys in the order in which they come; to be used again and again.
 *
 * At most a quarter of the slots is taken, or an eighth. A slot holds a number + 1 in
 * its lower bits, and bits of the hash above them. */
template <typename Key> class LatticeTable {
public:
  explicit LatticeTable(SimdTier tier) : loops_(kernels::latticeBuilding(tier)) {}

  /** \brief Forgets all keys and makes room for some. */
  void
  reset(std::size_t expected)
  {
    size_ = 0;
    keys_.resize(std::max<std::size_t>(expected, 1)); // a search may read the first
    setSlots(4 * expected);
  }

  /** \brief Numbers keys that are all different. */
  template <typename KeyOf>
  void
  fill(std::size_t count, KeyOf&& key_of)
  {
    size_ = count;
    keys_.resize(std::max<std::size_t>(count, 1));
    for (std::size_t i = 0; i < count; ++i) // all at first, as they come from anywhere
      keys_[i] = key_of(i);
    setSlots(8 * count);
    insertAll();
  }

  /** \brief The numbers of keys, which are new or not. */
  void
  insert(const Key* keys, std::size_t count, std::int32_t* numbers)
  {
    if (4 * (size_ + count) > slots_.size()) {
      setSlots(4 * (2 * size_ + count));
      insertAll();
    }
    if (size_ + count > keys_.size())
      keys_.resize(2 * size_ + count);
    findFirst(keys, count, numbers);
    const View view = this->view();
    Key* const known = keys_.data();
    std::size_t size = size_;
    for (std::size_t i = 0; i < count; ++i) {
      if (numbers[i] >= 0)
        continue;
      const std::uint64_t hash = LatticeKeys<Key>::hash(keys[i]);
      std::uint32_t& slot = slots_[view.search(keys[i], hash)];
      if (slot == 0) {
        known[size++] = keys[i];
        slot = view.entry(hash, size);
      }
      numbers[i] = std::int32_t(slot & view.number_mask) - 1;
    }
    size_ = size;
  }

  /** \brief The numbers of keys, -1 if they are unknown. */
  void
  find(const Key* keys, std::size_t count, std::int32_t* numbers) const
  {
    findFirst(keys, count, numbers);
    const View view = this->view();
    for (std::size_t i = 0; i < count; ++i) {
      if (numbers[i] != kernels::not_first)
        continue;
      const std::size_t slot = view.search(keys[i], LatticeKeys<Key>::hash(keys[i]));
      numbers[i] = std::int32_t(view.slots[slot] & view.number_mask) - 1;
    }
  }

  const Key*
  keys() const
  {
    return keys_.data();
  }

  std::size_t
  size() const
  {
    return size_;
  }

private:
  using View = LatticeSlots<Key>;

  // Numbers of the keys that are where they are looked for first.
  void
  findFirst(const Key* keys, std::size_t count, std::int32_t* numbers) const
  {
    if constexpr (sizeof(Key) == sizeof(std::uint64_t))
      loops_.search({slots_.data(), keys_.data(), shift_, number_mask_}, keys, count,
                    numbers);
    else
      std::fill_n(numbers, count, kernels::not_first);
  }

  View
  view() const
  {
    return {slots_.data(), keys_.data(), shift_, number_mask_};
  }

  void
  setSlots(std::size_t least)
  {
    for (shift_ = 64 - 8; (std::size_t(1) << (64 - shift_)) < least;)
      --shift_;
    slots_.assign(std::size_t(1) << (64 - shift_), 0);
    number_mask_ = std::uint32_t(slots_.size() - 1);
  }

  void
  insertAll()
  {
    const View view = this->view();
    for (std::size_t i = 0; i < size_; ++i) {
      const std::uint64_t hash = LatticeKeys<Key>::hash(view.keys[i]);
      std::size_t slot = std::size_t(hash >> view.shift);
      while (slots_[slot] != 0)
        slot = (slot + 1) & view.number_mask;
      slots_[slot] = view.entry(hash, i + 1);
    }
  }

  const kernels::LatticeBuilding& loops_;
  int shift_ = 64;
  std::uint32_t number_mask_ = 0;
  std::vector<std::uint32_t> slots_; // 0 = free
  std::vector<Key> keys_;            // with room for more
  std::size_t size_ = 0;
};

} // namespace pcl_semantic
