// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "smoothing.h"

/** \brief Inner loops of Elas, on raw pointers. Integer arithmetic: identical results
 * in all tiers. */
namespace pcl_semantic::kernels {

constexpr int descriptor_bytes = 16;        ///< per pixel
constexpr int largest_disparities = 1024;   ///< search range [px]
constexpr std::uint16_t no_energy = 0x5000; ///< larger than any candidate's energy

/** \brief Readable margin of rows of gradients and descriptors at both ends [px]. */
constexpr int gradient_margin = 48;
constexpr int descriptor_margin = 32;

/** \brief A row of an image whose pixels are matched. */
struct MatchRow {
  const std::uint8_t *own, *other; ///< descriptors of the first pixel
  int width;
  int disparities;           ///< a multiple of 8
  int direction;             ///< the other pixel is at u + direction * d: -1 or 1
  const std::int16_t* plane; ///< disparity expected by the prior; no_disparity = none
  /** \brief For each cell, bit d % 8 of byte d / 8 is set if a support point near the
   * cell has disparity d. */
  const std::uint8_t* seen;
  int cell_size; ///< [px]
  /** \brief Prior energy of the eight disparities from floor(expected) - 3 on, in the
   * order of the pixels in the other image, for each fraction of the expected
   * disparity. */
  const std::uint16_t* prior;
  std::uint16_t floor; ///< energy of disparities from nearby support points
};

struct ElasLoops {
  /** \brief Computes the gradients of a row as bytes around 128. */
  void (*gradients)(const std::uint8_t* above, const std::uint8_t* row,
                    const std::uint8_t* below, int width, std::uint8_t* horizontal,
                    std::uint8_t* vertical);

  /** \brief Gathers the descriptors of \a count pixels (a multiple of 16).
   * \param[in] elements addresses of the descriptor_bytes elements of the first pixel;
   * those of the next pixel are one byte further
   * \param[out] descriptors consecutive */
  void (*gather)(const std::uint8_t* const* elements, int count,
                 std::uint8_t* descriptors);

  /** \brief Adds to \a count costs (a multiple of 8) the distances of \a own descriptor
   * to the consecutive descriptors at \a others. */
  void (*addDistances)(const std::uint8_t* own, const std::uint8_t* others, int count,
                       std::uint16_t* costs);

  /** \brief Finds the disparity of minimum energy of each pixel, with its fraction;
   * no_disparity without candidates. The energy is the sum of the prior's energy and
   * the descriptors' distance. */
  void (*match)(const MatchRow& row, std::int16_t* disparity);
};

const ElasLoops& elasLoops(SimdTier tier);

} // namespace pcl_semantic::kernels
