// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kernels/lattice_building.h"

#include <cstddef>
#include <cstdint>

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
  std::int64_t low[kernels::max_dimensions + 1] = {};
  int shift[kernels::max_dimensions + 2] = {}; ///< and, behind the last, all bits
  int bits = 0;                                ///< of a key

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
      shift[j + 1] = bits;
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
    for (int j = 1; j <= d; ++j)
      cell_masks_[j] = (std::uint64_t(1) << (bits.shift[j + 1] - bits.shift[j])) - 1;
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

  /** \brief Cell j of 1 ... d, from its lowest. */
  std::uint64_t
  cell(Key key, int j) const
  {
    return std::uint64_t(key >> bits_.shift[j]) & cell_masks_[j];
  }

  /** \brief Mixes all bits of a key into the upper ones, and those into the lower. */
  static std::uint64_t
  hash(Key key)
  {
    if constexpr (sizeof(Key) > 8)
      return kernels::mixKey(std::uint64_t(key) ^
                             std::uint64_t(key >> 64) * 0xD6E8FEB86659FD93u);
    else
      return kernels::mixKey(key);
  }

private:
  LatticeKeyBits bits_;
  Key wrap_ = 0; // from remainder d + 1 to 0
  Key steps_[kernels::max_dimensions + 1];
  std::uint64_t cell_masks_[kernels::max_dimensions + 1] = {};
};

} // namespace pcl_semantic
