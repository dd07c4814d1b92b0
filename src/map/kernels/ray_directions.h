// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

/** \brief Ends and directions of rays in batches, on raw arrays. */
namespace pcl_semantic::kernels {

/** \brief Start of all rays and the transform of their ends. The operations are those
 * of quantize(pose * (fraction * point)), so that ends are bit-identical. */
struct RayStart {
  double pose[3][4];        ///< sensor to world, row by row [m]
  double scale;             ///< quanta per metre
  double start[3];          ///< quantised, integers
  std::int32_t in_voxel[3]; ///< start relative to the corner of its voxel [quanta]
};

/** \brief A batch of rays as one array per member. */
struct RayBatch {
  static constexpr std::size_t capacity = 128;

  std::size_t count = 0;
  // Input: index in the scan, point in the sensor's frame [m], and the fraction of the
  // distance at which the ray ends.
  std::uint32_t point[capacity];
  float x[capacity], y[capacity], z[capacity];
  double fraction[capacity];
  // Output: end relative to the start [quanta, voxels], by axis; members of
  // DirectedRay.
  std::int32_t end[3][capacity], cell[3][capacity];
  float row_slope[capacity], column_slope[capacity];
  std::int32_t end_slab[capacity], end_row[capacity], end_column[capacity],
      tile[capacity], leaf[capacity];
};

using FindDirections = void (*)(const RayStart& start, RayBatch& rays);

FindDirections findDirections(SimdTier tier);

} // namespace pcl_semantic::kernels
