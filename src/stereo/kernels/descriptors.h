// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstdint>

/** \brief Descriptors of the pixels of a row, and their distances: raw pointers and
 * sizes only. Whole numbers: the same in all tiers. */
namespace pcl_semantic::kernels {

constexpr int descriptor_parts = 1; ///< of 16 bytes
constexpr int descriptor_bytes = 16 * descriptor_parts;

/** \brief Rows of gradients and of descriptors can be read this far beyond both ends
 * [px]. */
constexpr int gradient_margin = 48;
constexpr int descriptor_margin = 32;

struct Descriptors {
  /** \brief Gradients of a row as bytes around 128. */
  void (*gradients)(const std::uint8_t* above, const std::uint8_t* row,
                    const std::uint8_t* below, int width, std::uint8_t* horizontal,
                    std::uint8_t* vertical);

  /** \brief Descriptors of \a count pixels (a multiple of 16).
   * \param[in] elements where each of the descriptor_bytes elements of the first pixel
   * lies; the next pixel's lie one byte further
   * \param[out] descriptors one after the other */
  void (*gather)(const std::uint8_t* const* elements, int count,
                 std::uint8_t* descriptors);

  /** \brief Adds to \a count costs (a multiple of 8) the distances of \a own
   * descriptor to those that lie one after the other at \a others. */
  void (*addDistances)(const std::uint8_t* own, const std::uint8_t* others, int count,
                       std::uint16_t* costs);
};

const Descriptors& descriptors(SimdTier tier);

} // namespace pcl_semantic::kernels
