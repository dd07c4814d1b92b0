// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Whether a value of a depth image is a measurement.
 *
 * Cameras and programs write "no measurement" as 0, as the largest 16-bit number, or as
 * a non-finite value.
 * \tparam T std::uint16_t, a number of a 16-bit image, or float, a depth [m] */
template <typename T>
bool
isMeasuredDepth(T depth)
{
  static_assert(std::is_same_v<T, std::uint16_t> || std::is_same_v<T, float>);
  if constexpr (std::is_same_v<T, float>)
    return std::isfinite(depth) && depth > 0.0f;
  else
    return depth > 0 && depth < std::numeric_limits<std::uint16_t>::max();
}

} // namespace pcl_semantic
