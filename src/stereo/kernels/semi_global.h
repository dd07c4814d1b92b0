// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

/** \brief Inner loops of semi-global matching, on raw pointers. D is the number of
 * disparities. Costs are one byte per pixel and disparity: D bytes of a pixel, then
 * those of the next pixel in the row. */
namespace pcl_semantic::kernels {

/** \brief Bytes of a pixel's census, one bit per comparison. */
constexpr int census_bytes = 4;

/** \brief D is a multiple of this. */
constexpr int disparity_block = 64;

/** \brief A *slot* contains the path costs of a pixel, followed by slot_padding bytes
 * of max_path_cost, an upper bound of the path costs; the same padding precedes the
 * first slot. max_path_cost plus a penalty of P1 fits a byte. */
constexpr int slot_padding = 64;
constexpr std::uint8_t max_path_cost = 191;

/** \brief Census of a row of both images, with an array for each byte of the census.
 * The right row is reversed: element width - 1 - u + d belongs to the pixel that
 * matches u at disparity d. */
struct CensusRow {
  int width, disparities;
  const std::uint8_t *left[census_bytes], *right[census_bytes];
};

/** \brief Inputs of the search for the best disparities of a row. */
struct PathRow {
  int width, disparities;
  const std::uint8_t* costs;
  std::uint8_t small_step; ///< P1: penalty of a disparity change by one pixel
  /// P2: penalty of a larger change. large_step_down[u]: from the pixel above to pixel
  /// u. large_step_along[u]: between pixels u - 1 and u of the row, in both directions.
  const std::uint8_t *large_step_down, *large_step_along;
  /// Slot of each pixel and the minimum of each slot. They contain the path costs of
  /// the previous row, which those of this row replace.
  std::uint8_t *down, *smallest_down;
  std::uint8_t* along; ///< slot of the current pixel, for the paths along the row
  std::uint16_t* sums; ///< over all directions; for each pixel the even disparities,
                       ///< then the odd ones
};

/** \brief Best matches of the pixels of a row. */
struct RowMatches {
  std::uint8_t* disparity; ///< of the smallest sum; in a tie the smallest
  std::uint16_t* around;   ///< three per pixel: the sums at d - 1, d, d + 1
  /// Whether a disparity other than d and its neighbours has a sum up to uniqueness
  /// times the smallest one.
  std::uint8_t* has_rival;
  float uniqueness;
  /// Of the right image's pixels, reversed as above, even and odd ones separately: the
  /// smallest sum so far (initially the largest value), and its disparity.
  std::uint16_t *right_sum[2], *right_disparity[2];
};

/** \brief Value for the sum of a disparity beyond the range. */
constexpr std::uint16_t no_sum = 65535;

struct SemiGlobal {
  /// Counts the differing bits of each pixel and disparity.
  void (*compare)(const CensusRow& row, std::uint8_t* costs);
  /// Updates sums over five rows: adds one row to \a sums, subtracts one (null = none);
  /// \a quarters are the sums divided by four.
  void (*slide)(const std::uint8_t* added, const std::uint8_t* removed,
                std::size_t count, std::uint8_t* sums, std::uint8_t* quarters);
  /// Computes the costs of 5 x 5 blocks from quarters: the number of differing bits
  /// divided by 16.
  void (*blocks)(const std::uint8_t* quarters, int width, int disparities,
                 std::uint8_t* costs);
  /// Sums the paths from above and from the left.
  void (*forward)(const PathRow& row);
  /// Adds the paths from the right, and selects the best disparities.
  void (*backward)(const PathRow& row, const RowMatches& matches);
};

/** \brief The loops for a tier; all tiers give identical results. */
const SemiGlobal& semiGlobal(SimdTier tier);

} // namespace pcl_semantic::kernels
