// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

/** \brief Sums of logarithms in fixed point: raw pointers and sizes only. */
namespace pcl_semantic::kernels {

/** \brief Units of a logarithm: 2^-24 is finer than single precision keeps. */
constexpr int log_fraction_bits = 24;

/** \brief Sums have room for a multiple of this. */
constexpr std::size_t log_block = 16;

/** \brief Adds to each of \a count sums the logarithm of max(value, smallest), to five
 * units; the same in all tiers.
 * \param[in] smallest positive and normal */
using AddLogs = void (*)(const float* values, std::size_t count, float smallest,
                         std::int64_t* sums);

AddLogs addLogs(SimdTier tier);

} // namespace pcl_semantic::kernels
