// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

/** \brief Mean of a pixel's similar neighbours along a line of the image, on raw
 * pointers. Identical results in all tiers. */
namespace pcl_semantic::kernels {

/** \brief Disparities are integers in units of 1 / disparity_steps px. */
constexpr int disparity_steps = 16;
constexpr std::int16_t no_disparity = -1;

constexpr int max_smoothing = 16; ///< radius [px]

/** \brief Smooths \a count disparities (below 0 = none, unchanged).
 * \param[in] disparity the first of them
 * \param[in] neighbours for each of 2 radius + 1 taps of the line, the address of the
 * first pixel's neighbour, followed by those of the others
 * \param[in] range neighbours that differ by more are ignored, from 0 to 1024
 * \param[out] smooth must not overlap the others */
using Smooth = void (*)(const std::int16_t* disparity,
                        const std::int16_t* const* neighbours, int taps, int range,
                        int count, std::int16_t* smooth);

Smooth smoothing(SimdTier tier);

} // namespace pcl_semantic::kernels
