// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

namespace pcl_semantic {

/** \brief Products of columns of probabilities, and what they are without one of their
 * factors. Factors are 0 or more than 1e-30; the stride of all columns is 8 or a
 * multiple of 16.
 *
 * A product without a factor is the whole one over this factor, so zeros are counted
 * instead of multiplied: a product is kept as it is if no factor is zero, as minus the
 * product of the others if one is, and as 0 if more are, or if it is below 1e-200.
 * Without any one factor such a product would still be below 1e-170. */
struct ColumnProducts {
  /** \brief product = that of columns(:, indices[e]), e < count.
   * \param[in] readable indices there are, as for ColumnSums::sum */
  void (*multiply)(const std::int32_t* indices, std::size_t count, std::size_t readable,
                   const float* columns, std::size_t stride, double* product);

  /** \brief result(:, r) += the sum of products(:, indices[e]) without their factor
   * factors(:, r), starts[r] <= e < starts[r + 1], for r < rows. */
  void (*add_without)(const std::size_t* starts, const std::int32_t* indices,
                      std::size_t rows, const double* products, const float* factors,
                      std::size_t stride, float* result);
};

const ColumnProducts& columnProductsFor(SimdTier tier);

/** \brief Those of simdTier(). */
const ColumnProducts& columnProducts();

} // namespace pcl_semantic
