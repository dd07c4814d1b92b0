// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

/** \brief Inner loops of semi-global matching: raw pointers and sizes only. D is the
 * number of disparities; values of a pixel are D bytes, those of a row width * D. */
namespace pcl_semantic::kernels {

/** \brief Bytes of a pixel's census, a bit for each comparison. */
constexpr int census_bytes = 4;

/** \brief D is a multiple of this. */
constexpr int disparity_block = 64;

/** \brief A *slot* holds the path costs of a pixel, and behind them so many bytes of
 * this value, which no path cost exceeds; the same lies before the first slot. It and a
 * penalty of P1 fit a byte. */
constexpr int slot_padding = 64;
constexpr std::uint8_t max_path_cost = 191;

/** \brief Census of a row of both images, by byte; the right one backwards: byte
 * width - 1 - u + d is that of the pixel that disparity d takes u to. */
struct CensusRow {
  int width, disparities;
  const std::uint8_t *left[census_bytes], *right[census_bytes];
};

/** \brief Inputs of the search for the best disparities of a row. */
struct PathRow {
  int width, disparities;
  const std::uint8_t* costs;
  std::uint8_t small_step; ///< P1: of a disparity that changes by one pixel
  /// P2: of one that changes by more, from the pixel above; and along the row, from the
  /// left and, one pixel on, from the right.
  const std::uint8_t *large_step_down, *large_step_along;
  /// Slot of each pixel, the smallest value of each: of the row above, then of this.
  std::uint8_t *down, *smallest_down;
  std::uint8_t* along; ///< one slot more
  std::uint16_t* sums; ///< of all directions; of a pixel even disparities, then odd
};

/** \brief Best matches of the pixels of a row. */
struct RowMatches {
  std::uint8_t* disparity; ///< of the smallest sum; of several the smallest
  std::uint16_t* around;   ///< three a pixel: the sums at d - 1, d, d + 1
  /// Whether a disparity beyond its neighbours has a sum up to uniqueness times the
  /// smallest one.
  std::uint8_t* has_rival;
  float uniqueness;
  /// Of the pixels of the right image, backwards as above, even and odd ones apart: the
  /// smallest sum, the largest value before, and its disparity.
  std::uint16_t *right_sum[2], *right_disparity[2];
};

/** \brief No sum; beyond the ends of the disparities. */
constexpr std::uint16_t no_sum = 65535;

struct SemiGlobal {
  /// Differing bits of each pixel and disparity.
  void (*compare)(const CensusRow& row, std::uint8_t* costs);
  /// Sums over five rows: adds one to \a sums, takes one off (null = none); \a quarters
  /// are the sums in fours.
  void (*slide)(const std::uint8_t* added, const std::uint8_t* removed,
                std::size_t count, std::uint8_t* sums, std::uint8_t* quarters);
  /// Costs of blocks from quarters, in sixteen bits.
  void (*blocks)(const std::uint8_t* quarters, int width, int disparities,
                 std::uint8_t* costs);
  /// Sums of the paths from above and from the left.
  void (*forward)(const PathRow& row);
  /// Adds the paths from the right, and chooses.
  void (*backward)(const PathRow& row, const RowMatches& matches);
};

/** \brief The same results in all tiers. */
const SemiGlobal& semiGlobal(SimdTier tier);

} // namespace pcl_semantic::kernels
