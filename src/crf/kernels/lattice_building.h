// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

/** \brief The inner loops that build a lattice: they find the simplex around each
 * point, vertices by their keys, and what a point hears of itself. */
namespace pcl_semantic::kernels {

constexpr int max_dimensions = 16;

/** \brief Points that are worked on at a time. */
constexpr std::size_t batch_points = 64;

/** \brief From features to the plane of the lattice: coordinate j of a point, in units
 * of d + 1, is sum over k > j of x_k less j x_j, x_k = scale[k] (f_(k-1) - low[k-1]).
 */
struct LatticeFrame {
  int dimensions;
  double low[max_dimensions];
  double scale[max_dimensions + 1];
};

/** \brief Simplices of 64 points. The vertex 0 has the coordinates (d + 1) cells[j];
 * vertex k + 1 lies one step in direction directions[k] ahead of vertex k. */
struct LatticeBatch {
  std::int32_t cells[max_dimensions + 1][batch_points];
  std::int32_t directions[max_dimensions + 1][batch_points];
  float weights[max_dimensions + 1][batch_points];
};

/** \brief Simplices of 64 points as they were found, and the paths between vertices:
 * bit S of the first (second) half of the sets of a row tells whether the vertices of
 * the path exist that steps ahead (back) from there in every direction j of the set S,
 * S = sum of 2^(d - j), in their order. */
struct LatticePaths {
  int dimensions;
  std::size_t words;              ///< of 64 bits in half a row
  const std::uint64_t* sets;      ///< by row
  const std::int32_t* rows;       ///< d + 1 a point
  const float* weights;           ///< d + 1 a point
  const std::uint8_t* directions; ///< (d + 1) x 64
};

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

struct LatticeBuilding {
  /** \brief Finds the simplices of 64 points. \param[in] features d a column
   * \param[in] columns of the points */
  void (*embed)(const LatticeFrame& frame, const float* features,
                const std::int32_t* columns, LatticeBatch& batch);

  /** \brief Looks for keys where they are looked for first, without a branch: many at a
   * time. \param[out] numbers -1 if they are unknown, not_first if another key is there
   */
  void (*search)(const LatticeTableView& table, const std::uint64_t* keys,
                 std::size_t count, std::int32_t* numbers);

  /** \brief What a one at each of 64 points sends back to it through splat, blur and
   * slice. */
  void (*selfResponse)(const LatticePaths& paths, float* responses);
};

/** \brief The loops for a tier. All give the same bits. */
const LatticeBuilding& latticeBuilding(SimdTier tier);

} // namespace pcl_semantic::kernels
