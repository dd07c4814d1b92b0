// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

namespace pcl_semantic {

/** \brief Sums of columns that lists of indices name. The stride of all columns is 8 or
 * a multiple of 16, and they start at multiples of 32 bytes. */
struct ColumnSums {
  /** \brief result(:, r) += sum of columns(:, indices[e]), starts[r] <= e <
   * starts[r+1], for r < rows. */
  void (*add)(const std::size_t* starts, const std::int32_t* indices, std::size_t rows,
              const float* columns, std::size_t stride, float* result);

  /** \brief sum = sum of columns(:, indices[e]), e < count, in double precision.
   * \param[in] readable indices there are, count or more: those behind are likely to be
   * asked for next, and are fetched */
  void (*sum)(const std::int32_t* indices, std::size_t count, std::size_t readable,
              const float* columns, std::size_t stride, double* sum);
};

const ColumnSums& columnSumsFor(SimdTier tier);

/** \brief Those of simdTier(). */
const ColumnSums& columnSums();

} // namespace pcl_semantic
