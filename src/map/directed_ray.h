// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstdint>

namespace pcl_semantic {

/** \brief End of a ray from its start, in units of 2^-10 voxel. */
using RayDelta = Eigen::Matrix<std::int32_t, 3, 1>;

/** \brief Longest extent of a ray along an axis of the sensor [voxels]: turned into the
 * world's it fits RayDelta. */
constexpr double kMaxRayVoxels = 1 << 20;

/** \brief A ray, seen along the axis on which it is longest, and the two others: row
 * and column. Slopes are per voxel of that axis, -1..1. */
struct DirectedRay {
  float row_slope, column_slope;
  std::int32_t end_slab;            ///< slab it ends in, counted from the start
  std::int32_t end_row, end_column; ///< voxel it ends in, from that of the start
  std::uint32_t point;              ///< its number in the scan
  std::uint16_t tile; ///< face (twice its axis, and one if it goes down), column, row
  std::uint16_t leaf; ///< offset in the tile, by interleaved bits
};

/** \brief Directions fall into tiles of an eighth of a radian, and these into leaves of
 * 1/256. */
constexpr int kTileBits = 4; // 16 x 16 tiles a face: slopes go from -1 to 1
constexpr int kLeafBits = 5;
constexpr int kTilesAFace = 1 << (2 * kTileBits);

} // namespace pcl_semantic
