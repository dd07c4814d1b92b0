// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

namespace pcl_semantic {

/** \brief A centre of SLIC's clustering: Lab colour (0..255 each) and position [px]. */
struct SlicCentre {
  float l = 0.0f;
  float a = 0.0f;
  float b = 0.0f;
  float x = 0.0f;
  float y = 0.0f;
};

/** \brief A row of the image and what is known of its pixels. */
struct SlicRow {
  const float* lab[3];        ///< channels
  float* distances = nullptr; ///< squared distance to the centre in `labels`
  int* labels = nullptr;
  int width = 0;
  float y = 0.0f; ///< of the row [px]
};

/** \brief Gives a centre those pixels first..end-1 of a row that it is nearer to than
 * the centre they have; `spatial_weight` is (m / S)^2, of the distance in the image. */
using AssignSlicRow = void (*)(const SlicRow& row, const SlicCentre& centre, int label,
                               int first, int end, float spatial_weight);

/** \brief The function for a tier; all give the same bits. */
AssignSlicRow slicAssignment(SimdTier tier);

} // namespace pcl_semantic
