// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Global integer coordinates of a voxel: it covers [index, index + 1) times the
 * voxel size in each axis of the world frame. */
using VoxelIndex = Eigen::Vector3i;

/** \brief Largest magnitude of an index: 100,000 km at 0.1 m, far from overflow. */
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

/** \brief Hash for unordered containers. */
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

/** \brief Quotient rounded towards minus infinity, for \a divisor > 0. */
constexpr std::int32_t
floorDivide(std::int32_t value, std::int32_t divisor)
{
  return value >= 0 ? value / divisor : -((-(value + 1)) / divisor) - 1;
}

} // namespace pcl_semantic
