// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_index.h>

#include <cstdint>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Bits of a voxel's edge that end points are quantised to. */
constexpr int kQuantizationBits = 10;

/** \brief A point in units of 2^-10 voxel, global. */
using QuantizedPoint = Eigen::Matrix<std::int64_t, 3, 1>;

/** \brief The voxel that holds a quantised point (voxels are half open). */
inline VoxelIndex
voxelOf(const QuantizedPoint& point)
{
  return {static_cast<std::int32_t>(point.x() >> kQuantizationBits),
          static_cast<std::int32_t>(point.y() >> kQuantizationBits),
          static_cast<std::int32_t>(point.z() >> kQuantizationBits)};
}

/** \brief The quantised point that holds a point.
 * \param[in] point as far as kMaxVoxelIndex voxels from the origin [m]
 * \param[in] voxel_size [m] */
inline QuantizedPoint
quantize(const Eigen::Vector3d& point, double voxel_size)
{
  const double scale = double(1 << kQuantizationBits) / voxel_size;
  QuantizedPoint quantized;
  for (int axis = 0; axis < 3; ++axis) {
    const double value = point[axis] * scale;
    const auto towards_zero = static_cast<std::int64_t>(value);
    quantized[axis] = towards_zero - (value < double(towards_zero)); // floor
  }
  return quantized;
}

} // namespace pcl_semantic
