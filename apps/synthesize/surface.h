// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "shapes.h"

namespace pcl_semantic::synthetic {

/** \brief A position along the street: \a s along the centre line, \a t to its left
 * [m]. */
struct RoadPoint {
  double s = 0.0;
  double t = 0.0;
};

/** \brief First surface along a ray, with all values for shading. */
struct Surface {
  double distance = 0.0; ///< in multiples of the ray's direction
  Label label = kUnlabelled;
  Material material = Material::grass;
  std::uint32_t id = 0;             ///< primitive; 0 is the ground
  Eigen::Vector3d point;            ///< world frame [m]
  Eigen::Vector3d normal;           ///< world frame, length 1
  Eigen::Vector3d local;            ///< point in the primitive's axes
  Eigen::Vector3d local_normal;     ///< normal in the primitive's axes
  const Primitive* solid = nullptr; ///< null for the ground
  RoadPoint road;                   ///< ground only
};

/** \brief Replaces a surface by that of the first solid that a ray enters before
 * surface.distance. \return whether such a solid exists */
bool nearestSolid(const BoxTree& solids, const Ray& ray, Surface& surface);

} // namespace pcl_semantic::synthetic
