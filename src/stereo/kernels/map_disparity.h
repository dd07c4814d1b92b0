// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "descriptors.h"

namespace pcl_semantic::kernels {

/** \brief Disparities are whole numbers of 1 / disparity_steps px. */
constexpr int disparity_steps = 16;
constexpr int largest_disparities = 1024; ///< it can look through [px]
constexpr std::int16_t no_disparity = -1;
constexpr std::uint16_t no_energy = 0x5000; ///< more than any candidate has

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

/** \brief Disparity of the least energy of each pixel, with its fraction; no_disparity
 * where there was no candidate. Energies are those of the prior and the descriptors'
 * distance. */
using MapDisparities = void (*)(const MatchRow& row, std::int16_t* disparity);

MapDisparities mapDisparities(SimdTier tier);

} // namespace pcl_semantic::kernels
