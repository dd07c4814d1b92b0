// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/simd.h>

#include <cstddef>
#include <cstdint>

/** \brief Ends and directions of rays, many at a time: raw arrays only. */
namespace pcl_semantic::kernels {

/** \brief Where all rays begin, and how points become ends: each operation as in
 * quantize(pose * (share * point)), so that ends are the same bit by bit. */
struct RayStart {
  double pose[3][4];        ///< sensor to world, row by row [m]
  double scale;             ///< quanta a metre
  double start[3];          ///< quantised, whole numbers
  std::int32_t in_voxel[3]; ///< the start from the corner of its voxel [quanta]
};

/** \brief Some rays, value by value. */
struct RayBatch {
  static constexpr std::size_t room = 128;

  std::size_t count = 0;
  // What is given of each: its number in the scan, whether the point is in range, the
  // point in the sensor's frame [m], and the share of the way to it at which it ends.
  std::uint32_t point[room];
  bool in_range[room];
  float x[room], y[room], z[room];
  double share[room];
  // What is found: the end from the start [quanta, voxels], by axis; members of
  // DirectedRay.
  std::int32_t end[3][room], cell[3][room];
  float row_slope[room], column_slope[room];
  std::int32_t end_slab[room], end_row[room], end_column[room], tile[room], leaf[room];
};

using FindDirections = void (*)(const RayStart& start, RayBatch& rays);

FindDirections findDirections(SimdTier tier);

} // namespace pcl_semantic::kernels
