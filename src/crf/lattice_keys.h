/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include "kernels/lattice_embedding.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

__extension__ typedef unsigned __int128 LongLatticeKey;

/** \brief How many bits the coordinates of vertices take, from their bounds.
 *
 * The coordinates of a vertex are (d + 1) cell_j + remainder, with one remainder for
 * all; their sum is 0, so cell_0 need not be kept. A key holds the remainder in its
 * lowest bits, then the cells 1 ... d, each with a margin of a few cells, so that the
 * keys of neighbours never carry into each other's bits. */
struct LatticeKeyBits {
  int dimensions = 0;
  int remainder_bits = 0;
  std::int64_t low[kernels::most_dimensions + 1] = {};
  int shift[kernels::most_dimensions + 1] = {};
  int bits = 0; ///< of a key

  /** \param[in] extents of the features from frame.low */
  LatticeKeyBits(const kernels::LatticeFrame& frame, const double* extents)
      : dimensions(frame.dimensions)
  {
    while ((1 << remainder_bits) < dimensions + 2)
      ++remainder_bits;
    bits = remainder_bits;
    for (int j = 1; j <= dimensions; ++j) {
      double high = 0.0;
      for (int k = j + 1; k <= dimensions; ++k)
        high += frame.scale[k] * extents[k - 1];
      constexpr std::int64_t margin = 4;
      low[j] = -std::int64_t(double(j) * frame.scale[j] * extents[j - 1]) - margin;
      shift[j] = bits;
      const std::int64_t cells = std::int64_t(high) + margin - low[j];
      while ((std::int64_t(1) << (bits - shift[j])) <= cells)
        ++bits;
    }
  }
};

/** \brief Arithmetic on keys of 64 or 128 bits. */
template <typename Key> class LatticeKeys {
public:
  explicit LatticeKeys(const LatticeKeyBits& bits) : bits_(bits)
  {
    const int d = bits.dimensions;
    for (int j = 1; j <= d; ++j)
      wrap_ += Key(1) << bits.shift[j];
    wrap_ -= Key(d + 1);
    for (int j = 0; j <= d; ++j)
      steps_[j] = Key(1) - (j > 0 ? Key(1) << bits.shift[j] : Key(0));
  }

  /** \brief The key of vertex 0 of a simplex. */
  Key
  first(const kernels::LatticeBatch& batch, std::size_t lane) const
  {
    Key key = 0;
    for (int j = 1; j <= bits_.dimensions; ++j)
      key += Key(std::uint64_t(batch.cells[j][lane] - bits_.low[j])) << bits_.shift[j];
    return key;
  }

  /** \brief From a vertex to the next one of a simplex. */
  Key
  inSimplex(Key key, int direction) const
  {
    return key + steps_[direction];
  }

  /** \brief The neighbour ahead in a direction. */
  Key
  ahead(Key key, int direction) const
  {
    key += steps_[direction];
    return remainder(key) == bits_.dimensions + 1 ? key + wrap_ : key;
  }

  /** \brief The neighbour back in a direction. */
  Key
  back(Key key, int direction) const
  {
    return (remainder(key) == 0 ? key - wrap_ : key) - steps_[direction];
  }

  int
  remainder(Key key) const
  {
    return int(key & ((Key(1) << bits_.remainder_bits) - 1));
  }

  /** \brief Cell j of 0 ... d, up to a constant. */
  std::int64_t
  cell(Key key, int j) const
  {
    if (j > 0) {
      const int end = j < bits_.dimensions ? bits_.shift[j + 1] : bits_.bits;
      return std::int64_t((key >> bits_.shift[j]) &
                          ((Key(1) << (end - bits_.shift[j])) - 1));
    }
    std::int64_t sum = -remainder(key);
    for (int l = 1; l <= bits_.dimensions; ++l)
      sum -= cell(key, l);
    return sum;
  }

  /** \brief Mixes all bits of a key into the upper ones. */
  static std::uint64_t
  hash(Key key)
  {
    std::uint64_t mixed = std::uint64_t(key);
    if constexpr (sizeof(Key) > 8)
      mixed ^= std::uint64_t(key >> 64) * 0xD6E8FEB86659FD93u;
    mixed = (mixed ^ (mixed >> 32)) * 0x9E3779B97F4A7C15u;
    return (mixed ^ (mixed >> 29)) * 0xBF58476D1CE4E5B9u;
  }

private:
  LatticeKeyBits bits_;
  Key wrap_ = 0; // from remainder d + 1 to 0
  Key steps_[kernels::most_dimensions + 1];
};

/** \brief Numbers keys in the order in which they come; to be used again and again. */
template <typename Key> class LatticeTable {
public:
  /** \brief Forgets all keys. */
  void
  clear()
  {
    std::fill(slots_.begin(), slots_.end(), 0);
    keys_.clear();
  }

  /** \brief The number of a key, which is new or not. */
  std::int32_t
  insert(Key key)
  {
    if (2 * keys_.size() >= slots_.size())
      grow();
    const std::size_t slot = search(key);
    if (slots_[slot] == 0) {
      keys_.push_back(key);
      slots_[slot] = std::int32_t(keys_.size());
    }
    return slots_[slot] - 1;
  }

  /** \brief The number of a key, -1 if it is unknown. */
  std::int32_t
  find(Key key) const
  {
    return slots_.empty() ? -1 : slots_[search(key)] - 1;
  }

  const std::vector<Key>&
  keys() const
  {
    return keys_;
  }

private:
  std::size_t
  search(Key key) const
  {
    std::size_t slot = std::size_t(LatticeKeys<Key>::hash(key) >> shift_);
    while (slots_[slot] != 0 && keys_[std::size_t(slots_[slot] - 1)] != key)
      slot = (slot + 1) & (slots_.size() - 1);
    return slot;
  }

  void
  grow()
  {
    shift_ = slots_.empty() ? 64 - 10 : shift_ - 1;
    slots_.assign(std::size_t(1) << (64 - shift_), 0);
    for (std::size_t i = 0; i < keys_.size(); ++i)
      slots_[search(keys_[i])] = std::int32_t(i + 1);
  }

  int shift_ = 64;
  std::vector<std::int32_t> slots_; // number + 1; 0 = free
  std::vector<Key> keys_;
};

} // namespace pcl_semantic
