// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

/** \brief The inner loops of mean-field inference, on columns with one row per label.
 * The stride (rows with padding) is 8 or a multiple of 16; columns start at multiples
 * of 32 bytes. */
namespace pcl_semantic::kernels {

/** \brief Cost of a padding row, whose probability is then zero. */
constexpr float padding_cost = 1e30f;

struct InferenceLoops {
  /** \brief marginals = columns of exp(messages - costs), normalised to sum to one;
   * then messages = 0 for the next sum. The relative error is 1e-6. Values below e^-55
   * of the largest become 0, because their products would be denormal, which is slow.
   * \param[in] costs of the rows; padding_cost in padding
   * \param[in,out] messages finite, read and cleared
   * \param[in] columns number of columns */
  void (*softMax)(const float* costs, float* messages, float* marginals,
                  std::size_t columns, std::size_t stride);

  /** \brief columns(:, i) = - matrix columns(:, i): converts messages about labels k to
   * messages about labels l, the negative mean of mu(l, k).
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
   * \param[in] readable number of indices, at least count; the columns of further ones
   * are prefetched for the next call */
  void (*sumColumns)(const std::int32_t* indices, std::size_t count,
                     std::size_t readable, const float* columns, std::size_t stride,
                     double* sum);

  /** \brief product = product of columns(:, indices[e]), e < count; factors are 0 or
   * more than 1e-30.
   *
   * The product without one factor is the whole product divided by that factor, so
   * zeros are counted instead of multiplied. The stored value is the product if no
   * factor is zero, minus the product of the others if one is zero, and 0 if more are
   * zero or the product is below 1e-200. Such a product would stay below 1e-170 without
   * any one factor.
   * \param[in] readable as for sumColumns */
  void (*multiplyColumns)(const std::int32_t* indices, std::size_t count,
                          std::size_t readable, const float* columns,
                          std::size_t stride, double* product);

  /** \brief result(:, r) += sum of products(:, indices[e]) without the factor
   * factors(:, r), starts[r] <= e < starts[r + 1], for r < rows. */
  void (*addWithout)(const std::size_t* starts, const std::int32_t* indices,
                     std::size_t rows, const double* products, const float* factors,
                     std::size_t stride, float* result);
};

/** \brief The loops for a tier; all tiers give identical bits. */
const InferenceLoops& inferenceLoops(SimdTier tier = simdTier());

} // namespace pcl_semantic::kernels
