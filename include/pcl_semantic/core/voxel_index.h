// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Global integer coordinates of a voxel: it covers [index, index + 1) times the
 * voxel size along each axis of the world frame. */
using VoxelIndex = Eigen::Vector3i;

/** \brief Largest magnitude of an index: 100,000 km at 0.1 m. */
constexpr std::int32_t kMaxVoxelIndex = 1000000000;

/** \brief Lexicographic order z, y, x. */
struct VoxelIndexLess {
  bool
  operator()(const VoxelIndex& a, const VoxelIndex& b) const
  {
    if (a.z() != b.z())
      return a.z() < b.z();
    if (a.y() != b.y())
      return a.y() < b.y();
    return a.x() < b.x();
  }
};

struct VoxelIndexHash {
  std::size_t
  operator()(const VoxelIndex& index) const
  {
    std::uint64_t hash = static_cast<std::uint32_t>(index.x());
    hash = hash * 0x9E3779B97F4A7C15ull + static_cast<std::uint32_t>(index.y());
    hash = hash * 0x9E3779B97F4A7C15ull + static_cast<std::uint32_t>(index.z());
    hash ^= hash >> 32;
    return static_cast<std::size_t>(hash * 0xD6E8FEB86659FD93ull);
  }
};

/** \brief Centre of a voxel, world frame [m].
 * \param[in] voxel VoxelIndex, or integers beyond its range
 * \param[in] voxel_size [m] */
template <typename Voxel>
Eigen::Vector3d
centreOf(const Eigen::MatrixBase<Voxel>& voxel, double voxel_size)
{
  return (voxel.template cast<double>().array() + 0.5) * voxel_size;
}

/** \brief log2 of the end points' resolution [1/voxel]. */
constexpr int kQuantizationBits = 10;

/** \brief A global point in units of 2^-10 voxel. */
using QuantizedPoint = Eigen::Matrix<std::int64_t, 3, 1>;

/** \brief The voxel that contains a quantised point (voxels are half open). */
inline VoxelIndex
voxelOf(const QuantizedPoint& point)
{
  return {static_cast<std::int32_t>(point.x() >> kQuantizationBits),
          static_cast<std::int32_t>(point.y() >> kQuantizationBits),
          static_cast<std::int32_t>(point.z() >> kQuantizationBits)};
}

/** \brief Quantises a point.
 * \param[in] point at most kMaxVoxelIndex voxels from the origin [m]
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

// Maps hold voxels in blocks of 8 x 8 x 8.
constexpr int kBlockBits = 3;
constexpr int kBlockEdge = 1 << kBlockBits;                        ///< edge in voxels
constexpr int kBlockVoxels = kBlockEdge * kBlockEdge * kBlockEdge; ///< number of voxels

inline VoxelIndex
blockOf(const VoxelIndex& voxel)
{
  return {voxel.x() >> kBlockBits, voxel.y() >> kBlockBits, voxel.z() >> kBlockBits};
}

/** \brief Offset of a voxel in its block: x fastest, z slowest. */
inline int
voxelInBlock(const VoxelIndex& voxel)
{
  constexpr int mask = kBlockEdge - 1;
  return (((voxel.z() & mask) << kBlockBits | (voxel.y() & mask)) << kBlockBits) |
         (voxel.x() & mask);
}

/** \brief The voxel at an offset in a block; inverse of blockOf() and voxelInBlock().
 */
inline VoxelIndex
voxelAt(const VoxelIndex& block, int offset)
{
  constexpr int mask = kBlockEdge - 1;
  return {block.x() * kBlockEdge + (offset & mask),
          block.y() * kBlockEdge + ((offset >> kBlockBits) & mask),
          block.z() * kBlockEdge + (offset >> (2 * kBlockBits))};
}

} // namespace pcl_semantic
