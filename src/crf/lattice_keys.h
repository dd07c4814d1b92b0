// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "aligned_array.h"
#include "kernels/lattice_loops.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

__extension__ typedef unsigned __int128 LongLatticeKey;

/** \brief Arithmetic on 64-bit or 128-bit keys.
 *
 * The coordinates of a vertex are (d + 1) cell_j + remainder with a common remainder.
 * Their sum is 0, so cell_0 is not stored. A key has the remainder in its lowest bits,
 * then the cells 1 ... d, each with a margin of a few cells, so that the keys of
 * neighbours never carry into each other's bits. */
template <typename Key> class LatticeKeys {
public:
  /** \param[in] extents of the features from frame.low */
  LatticeKeys(const kernels::LatticeFrame& frame, const double* extents)
      : dimensions_(frame.dimensions)
  {
    while ((1 << bits_) < dimensions_ + 2)
      ++bits_;
    remainder_mask_ = (std::uint32_t(1) << bits_) - 1;
    wrap_ = 0 - Key(dimensions_ + 1);
    steps_[0] = 1;
    for (int j = 1; j <= dimensions_; ++j) {
      double high = 0.0;
      for (int k = j + 1; k <= dimensions_; ++k)
        high += frame.scale[k] * extents[k - 1];
      constexpr std::int64_t margin = 4;
      low_[j] = -std::int64_t(double(j) * frame.scale[j] * extents[j - 1]) - margin;
      shift_[j] = bits_;
      const std::int64_t cells = std::int64_t(high) + margin - low_[j];
      while ((std::int64_t(1) << (bits_ - shift_[j])) <= cells)
        ++bits_;
      cell_masks_[j] = (std::uint64_t(1) << (bits_ - shift_[j])) - 1;
      const Key cell = shift_[j] < int(8 * sizeof(Key)) ? Key(1) << shift_[j] : 0;
      wrap_ += cell;
      steps_[j] = 1 - cell;
    }
  }

  /** \brief Bits that a key needs: keys are wrong if it has fewer. */
  int
  bits() const
  {
    return bits_;
  }

  /** \brief The key of vertex 0 of a simplex. */
  Key
  first(const kernels::LatticeBatch& batch, std::size_t lane) const
  {
    Key key = 0;
    for (int j = 1; j <= dimensions_; ++j)
      key += Key(std::uint64_t(batch.cells[j][lane] - low_[j])) << shift_[j];
    return key;
  }

  Key
  ahead(Key key, int direction) const
  {
    key += steps_[direction];
    return remainder(key) == dimensions_ + 1 ? key + wrap_ : key;
  }

  Key
  back(Key key, int direction) const
  {
    return (remainder(key) == 0 ? key - wrap_ : key) - steps_[direction];
  }

  /** \brief A 32-bit hash that is the same for all vertices of a sheet, those reachable
   * by steps in the directions from begin to before end: a hash of the differences of
   * the other cells. Cell 0 follows from the others and the remainder. */
  std::uint64_t
  sheet(Key key, int begin, int end) const
  {
    std::uint64_t cells[kernels::max_dimensions + 1];
    cells[0] = 0 - std::uint64_t(remainder(key));
    for (int j = 1; j <= dimensions_; ++j) {
      cells[j] = std::uint64_t(key >> shift_[j]) & cell_masks_[j];
      cells[0] -= cells[j];
    }
    const std::uint64_t last = cells[end <= dimensions_ ? dimensions_ : begin - 1];
    std::uint64_t hash = 0;
    for (int j = 0; j <= dimensions_; ++j)
      if (j < begin || j >= end)
        hash = (hash + cells[j] - last) * 0x5851F42D4C957F2Du;
    return ((hash ^ (hash >> 31)) * 0x9E3779B97F4A7C15u) >> 32;
  }

private:
  int
  remainder(Key key) const
  {
    return int(std::uint32_t(key) & remainder_mask_);
  }

  int dimensions_;
  int bits_ = 0;
  std::uint32_t remainder_mask_ = 0;
  std::int64_t low_[kernels::max_dimensions + 1] = {};
  int shift_[kernels::max_dimensions + 1] = {};
  std::uint64_t cell_masks_[kernels::max_dimensions + 1] = {};
  Key steps_[kernels::max_dimensions + 1] = {};
  Key wrap_ = 0;
};

/** \brief Numbers keys in the order of insertion: a hash table with open addressing, at
 * most half full. A slot is 0 (free) or holds a number + 1 in its lower bits and bits
 * of the hash above them, which avoids most key comparisons. */
template <typename Key> class LatticeTable {
public:
  /** \brief Removes all keys and reserves capacity. */
  void
  reset(std::size_t expected)
  {
    keys_.clear();
    keys_.reserve(expected);
    setSlots(2 * expected);
  }

  /** \brief The number of a key, inserted if new. */
  std::int32_t
  insert(Key key)
  {
    if (2 * (keys_.size() + 1) > slots_.size()) {
      setSlots(2 * slots_.size());
      for (std::size_t i = 0; i < keys_.size(); ++i)
        slots_[search(keys_[i], hash(keys_[i]))] = entry(hash(keys_[i]), i + 1);
    }
    const std::uint64_t hash = this->hash(key);
    std::uint32_t& slot = slots_[search(key, hash)];
    if (slot == 0) {
      keys_.push_back(key);
      slot = entry(hash, keys_.size());
    }
    return numberIn(slot);
  }

  /** \brief The number of a key; -1 if it is missing. */
  std::int32_t
  find(Key key) const
  {
    return numberIn(slots_[search(key, hash(key))]);
  }

  const std::vector<Key>&
  keys() const
  {
    return keys_;
  }

private:
  static std::uint64_t
  hash(Key key)
  {
    std::uint64_t mixed = std::uint64_t(key) * 0x9E3779B97F4A7C15u;
    if constexpr (sizeof(Key) > 8)
      mixed += std::uint64_t(key >> 64) * 0xD6E8FEB86659FD93u;
    return (mixed ^ (mixed >> 32)) * 0xBF58476D1CE4E5B9u;
  }

  std::uint32_t
  entry(std::uint64_t hash, std::size_t number) const
  {
    return (std::uint32_t(hash) & ~number_mask_) | std::uint32_t(number);
  }

  std::int32_t
  numberIn(std::uint32_t slot) const
  {
    return std::int32_t(slot & number_mask_) - 1;
  }

  // The slot of a key, or the free slot for it.
  std::size_t
  search(Key key, std::uint64_t hash) const
  {
    const std::uint32_t tag = entry(hash, 0);
    for (auto slot = std::size_t(hash >> shift_);; slot = (slot + 1) & number_mask_) {
      const std::uint32_t found = slots_[slot];
      if (found == 0 ||
          ((found & ~number_mask_) == tag && keys_[(found & number_mask_) - 1] == key))
        return slot;
    }
  }

  void
  setSlots(std::size_t least)
  {
    for (shift_ = 64 - 8; (std::size_t(1) << (64 - shift_)) < least;)
      --shift_;
    const std::size_t size = std::size_t(1) << (64 - shift_);
    if (size != slots_.size())
      slots_ = AlignedArray<std::uint32_t>(size);
    std::fill_n(slots_.data(), size, 0);
    number_mask_ = std::uint32_t(size - 1);
  }

  int shift_ = 0; // of hashes, to get slots
  std::uint32_t number_mask_ = 0;
  AlignedArray<std::uint32_t> slots_;
  std::vector<Key> keys_;
};

} // namespace pcl_semantic
