/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <limits>

namespace pcl_semantic {

/** \brief What tells classes apart whatever a network thinks; NaN = not known. */
struct PointGeometry {
  float height = std::numeric_limits<float>::quiet_NaN();   ///< above the ground [m]
  float distance = std::numeric_limits<float>::quiet_NaN(); ///< along the view [m]
  /// How level the surface is: |cosine| of the angle between its normal and that of the
  /// ground; 1 = a floor, 0 = a wall.
  float level = std::numeric_limits<float>::quiet_NaN();
};

} // namespace pcl_semantic
