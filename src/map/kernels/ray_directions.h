// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

/** \brief Ends and directions of rays, many at a time: raw arrays only. */
namespace pcl_semantic::kernels {

/** \brief Where all rays begin, and how points become ends: each operation as in
 * quantize(pose * (fraction * point)), so that ends are the same bit by bit. */
struct RayStart {
  double pose[3][4];        ///< sensor to world, row by row [m]
  double scale;             ///< quanta a metre
  double start[3];          ///< quantised, whole numbers
  std::int32_t in_voxel[3]; ///< the start from the corner of its voxel [quanta]
};

/** \brief Some rays, value by value. */
struct RayBatch {
  static constexpr std::size_t capacity = 128;

  std::size_t count = 0;
  // What is given of each: its number in the scan, the point in the sensor's frame [m],
  // and the fraction of the way to it at which it ends.
  std::uint32_t point[capacity];
  float x[capacity], y[capacity], z[capacity];
  double fraction[capacity];
  // What is found: the end from the start [quanta, voxels], by axis; members of
  // DirectedRay.
  std::int32_t end[3][capacity], cell[3][capacity];
  float row_slope[capacity], column_slope[capacity];
  std::int32_t end_slab[capacity], end_row[capacity], end_column[capacity],
      tile[capacity], leaf[capacity];
};

using FindDirections = void (*)(const RayStart& start, RayBatch& rays);

FindDirections findDirections(SimdTier tier);

} // namespace pcl_semantic::kernels
