// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "smoothing.h"

/** \brief Inner loops of Elas: raw pointers and sizes only. Whole numbers: the same in
 * all tiers. */
namespace pcl_semantic::kernels {

constexpr int descriptor_bytes = 16;        ///< of a pixel
constexpr int largest_disparities = 1024;   ///< that can be looked through [px]
constexpr std::uint16_t no_energy = 0x5000; ///< more than any candidate has

/** \brief Rows of gradients and of descriptors can be read this far beyond both ends
 * [px]. */
constexpr int gradient_margin = 48;
constexpr int descriptor_margin = 32;

/** \brief A row of an image whose pixels are to be matched. */
struct MatchRow {
  const std::uint8_t *own, *other; ///< descriptors of the first pixel
  int width;
  int disparities;           ///< a multiple of 8
  int direction;             ///< the other pixel is at u + direction * d: -1 or 1
  const std::int16_t* plane; ///< what the prior expects; no_disparity = nothing
  /** \brief Of the pixels' cells: bit d % 8 of byte d / 8 is set if some support point
   * near the cell has disparity d. */
  const std::uint8_t* seen;
  int cell_size; ///< [px]
  /** \brief Energy of the eight disparities from floor(expected) - 3 on, in the order
   * of the pixels in the other image, for each fraction of the expected disparity. */
  const std::uint16_t* prior;
  std::uint16_t floor; ///< energy of those seen near
};

struct ElasLoops {
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

  /** \brief Disparity of the least energy of each pixel, with its fraction;
   * no_disparity where there was no candidate. Energies are those of the prior and the
   * descriptors' distance. */
  void (*match)(const MatchRow& row, std::int16_t* disparity);
};

const ElasLoops& elasLoops(SimdTier tier);

} // namespace pcl_semantic::kernels
