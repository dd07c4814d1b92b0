// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

/** \brief Mean of a pixel's neighbours in a line of the image, of those that are like
 * it: raw pointers and sizes only. The same in all tiers. */
namespace pcl_semantic::kernels {

/** \brief Disparities are whole numbers of 1 / disparity_steps px. */
constexpr int disparity_steps = 16;
constexpr std::int16_t no_disparity = -1;

constexpr int max_smoothing = 16; ///< radius [px]

/** \brief Smooths \a count disparities (below 0 = none, stays).
 * \param[in] disparity the first of them
 * \param[in] neighbours where, for each of 2 radius + 1 taps of the line, the
 * neighbour of the first lies; those of the others follow
 * \param[in] range neighbours that differ by more do not count, from 0 to 1024
 * \param[out] smooth may not overlap the others */
using Smooth = void (*)(const std::int16_t* disparity,
                        const std::int16_t* const* neighbours, int taps, int range,
                        int count, std::int16_t* smooth);

Smooth smoothing(SimdTier tier);

} // namespace pcl_semantic::kernels
