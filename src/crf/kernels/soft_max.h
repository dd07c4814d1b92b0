// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>

namespace pcl_semantic {

/** \brief Cost of a row that only fills up a column: its probability is zero. */
constexpr float kPaddingCost = 1e30f;

/** \brief marginals = columns of exp(messages - costs) that sum to one. They are right
 * to 1e-6 of themselves, or 0 below e^-55 of the largest: products of such would be
 * denormal, which is slow. Then messages = 0, for the next ones to be added up.
 * \param[in] costs of the rows; kPaddingCost in padding. Columns start at multiples of
 * 32 bytes.
 * \param[in,out] messages finite, read and cleared; as costs
 * \param[in,out] marginals the old ones are compared with the new ones; as costs
 * \param[in] columns how many
 * \param[in] stride rows of a column: 8 or a multiple of 16
 * \return the largest change of a marginal */
using SoftMax = float (*)(const float* costs, float* messages, float* marginals,
                          std::size_t columns, std::size_t stride);

SoftMax softMaxFor(SimdTier tier);

/** \brief That of simdTier(). */
float softMax(const float* costs, float* messages, float* marginals,
              std::size_t columns, std::size_t stride);

} // namespace pcl_semantic
