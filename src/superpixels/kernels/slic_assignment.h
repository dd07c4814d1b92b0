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

/** \brief A row of the image and the current assignment of its pixels. */
struct SlicRow {
  const float* lab[3];        ///< channels
  float* distances = nullptr; ///< squared distance to the centre in `labels`
  int* labels = nullptr;
  int width = 0;
  float y = 0.0f; ///< of the row [px]
};

/** \brief Assigns to a centre those of the pixels first..end-1 of a row that are closer
 * to it than to their current centre; `spatial_weight` is (m / S)^2, the weight of the
 * squared image distance. */
using AssignSlicRow = void (*)(const SlicRow& row, const SlicCentre& centre, int label,
                               int first, int end, float spatial_weight);

/** \brief The function for a tier; all give identical bits. */
AssignSlicRow slicAssignment(SimdTier tier);

} // namespace pcl_semantic
