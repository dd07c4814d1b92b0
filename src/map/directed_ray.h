// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstdint>

namespace pcl_semantic {

/** \brief End of a ray relative to its start, in units of 2^-10 voxel. */
using RayDelta = Eigen::Matrix<std::int32_t, 3, 1>;

/** \brief Largest extent of a ray along an axis of the sensor [voxels]. After rotation
 * to the world frame it fits RayDelta. */
constexpr double kMaxRayVoxels = 1 << 20;

/** \brief A ray relative to its longest axis; the other two axes are row and column.
 * Slopes are per voxel of the longest axis, -1..1. */
struct DirectedRay {
  float row_slope, column_slope;
  std::int32_t end_slab;            ///< slab of its end, counted from the start
  std::int32_t end_row, end_column; ///< voxel of its end, relative to the start
  std::uint32_t point;              ///< its index in the scan
  std::uint16_t tile;               ///< face (2 axis + 1 if negative), column, row
  std::uint16_t leaf;               ///< offset in the tile, by interleaved bits
};

/** \brief Directions are divided into tiles of an eighth of a radian, and tiles into
 * leaves of 1/256. */
constexpr int kTileBits = 4; // 16 x 16 tiles per face: slopes go from -1 to 1
constexpr int kLeafBits = 5;
constexpr int kTilesAFace = 1 << (2 * kTileBits);

} // namespace pcl_semantic
