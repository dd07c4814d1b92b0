// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

/** \brief The inner loops of mean-field inference, on columns with one row a label. The
 * stride of all columns, rows with padding, is 8 or a multiple of 16; they start at
 * multiples of 32 bytes. */
namespace pcl_semantic::kernels {

/** \brief Cost of a row that only fills up a column: its probability is zero. */
constexpr float padding_cost = 1e30f;

struct InferenceLoops {
  /** \brief marginals = columns of exp(messages - costs) that sum to one. They are
   * right to 1e-6 of themselves, or 0 below e^-55 of the largest: products of such
   * would be denormal, which is slow. Then messages = 0, for the next ones to be added
   * up.
   * \param[in] costs of the rows; padding_cost in padding
   * \param[in,out] messages finite, read and cleared
   * \param[in] columns how many */
  void (*softMax)(const float* costs, float* messages, float* marginals,
                  std::size_t columns, std::size_t stride);

  /** \brief columns(:, i) = - matrix columns(:, i): what was heard of labels k becomes
   * what is said of labels l, minus the mean of mu(l, k).
   * \param[in] matrix mu(l, k), column k; rows and columns of padding are zero or
   * missing
   * \param[in] labels of the matrix, up to 256
   * \param[in] count of the columns
   * \param[in] stride of matrix and columns, up to 256 */
  void (*mixLabels)(const float* matrix, std::size_t labels, float* columns,
                    std::size_t count, std::size_t stride);

  /** \brief result(:, r) += sum of columns(:, indices[e]), starts[r] <= e <
   * starts[r+1], for r < rows. */
  void (*addColumns)(const std::size_t* starts, const std::int32_t* indices,
                     std::size_t rows, const float* columns, std::size_t stride,
                     float* result);

  /** \brief sum = sum of columns(:, indices[e]), e < count, in double precision.
   * \param[in] readable indices there are, count or more: those behind are likely to be
   * asked for next, and are fetched */
  void (*sumColumns)(const std::int32_t* indices, std::size_t count,
                     std::size_t readable, const float* columns, std::size_t stride,
                     double* sum);

  /** \brief product = that of columns(:, indices[e]), e < count; factors are 0 or more
   * than 1e-30.
   *
   * A product without one factor is the whole one over this factor, so zeros are
   * counted instead of multiplied: a product is kept as it is if no factor is zero, as
   * minus the product of the others if one is, and as 0 if more are, or if it is below
   * 1e-200. Without any one factor such a product would still be below 1e-170.
   * \param[in] readable as for sumColumns */
  void (*multiplyColumns)(const std::int32_t* indices, std::size_t count,
                          std::size_t readable, const float* columns,
                          std::size_t stride, double* product);

  /** \brief result(:, r) += the sum of products(:, indices[e]) without their factor
   * factors(:, r), starts[r] <= e < starts[r + 1], for r < rows. */
  void (*addWithout)(const std::size_t* starts, const std::int32_t* indices,
                     std::size_t rows, const double* products, const float* factors,
                     std::size_t stride, float* result);
};

/** \brief The loops for a tier; all tiers give the same bits. */
const InferenceLoops& inferenceLoops(SimdTier tier = simdTier());

} // namespace pcl_semantic::kernels
