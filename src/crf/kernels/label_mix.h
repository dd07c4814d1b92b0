// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>

namespace pcl_semantic {

/** \brief columns(:, i) = - matrix columns(:, i): what was heard of labels k becomes
 * what is said of labels l, minus the mean of mu(l, k). \param[in] matrix mu(l, k),
 * column k; rows and columns of padding are zero or missing \param[in] labels of the
 * matrix, up to 256 \param[in,out] columns start at multiples of 32 bytes \param[in]
 * count of the columns \param[in] stride of matrix and columns: 8 or a multiple of 16
 * up to 256 */
using LabelMix = void (*)(const float* matrix, std::size_t labels, float* columns,
                          std::size_t count, std::size_t stride);

LabelMix labelMixFor(SimdTier tier);

/** \brief That of simdTier(). */
void mixLabels(const float* matrix, std::size_t labels, float* columns,
               std::size_t count, std::size_t stride);

} // namespace pcl_semantic
