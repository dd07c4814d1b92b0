// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

namespace pcl_semantic::kernels {

/** \brief A run of sorted points packs its first point and its length. */
constexpr int run_length_bits = 5;
constexpr std::uint32_t run_length_mask = (1 << run_length_bits) - 1;
constexpr std::uint32_t longest_run = 16;

/** \brief Rows of points near a row, one array each, with 16 rows of no cells more. */
struct NearRowsView {
  const std::uint32_t* starts;      ///< number of points before each cell of all rows
  const std::int32_t* first_starts; ///< where in starts a row begins
  const std::int32_t* first_cells;  ///< of the rows
  const std::int32_t* cells;        ///< number of them
  const std::int32_t* widths;       ///< how far to look to each side [cells]
  std::size_t count;                ///< of the rows
};

constexpr std::size_t run_too_long = std::size_t(-1);

/** \brief Writes the runs of points that lie within the width of the cells first to
 * last in each row, leaving out empty ones. \param[out] runs with room for count + 16
 * \return number of runs, or run_too_long if one is longer than longest_run */
using RunSearch = std::size_t (*)(const NearRowsView& rows, std::int32_t first,
                                  std::int32_t last, std::uint32_t* runs);

/** \brief The search for a tier. */
RunSearch runSearch(SimdTier tier);

} // namespace pcl_semantic::kernels
