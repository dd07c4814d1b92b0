// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "synthetic_road.h"
#include "synthetic_shapes.h"

namespace pcl_semantic::synthetic {

/** \brief What a ray sees of the street, with all that shading needs. */
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

/** \brief Geometry of the street: the ground, which follows the road line, and all the
 * solids that stand on it. */
class Street {
public:
  static constexpr double road_height = -1.65; ///< z of the road, world frame [m]
  static constexpr double lane = -1.6;         ///< t of the camera's lane [m]
  static constexpr double sight = 400.0;       ///< where the ground ends [m]

  /** \param[in] length way that the camera drives [m] */
  Street(std::uint32_t seed, double length);

  const RoadLine&
  road() const
  {
    return road_;
  }

  std::uint32_t
  seed() const
  {
    return seed_;
  }

  /** \brief The first surface along a ray. \return false: the sky */
  bool nearest(const Ray& ray, Surface& surface) const;

  /** \brief Whether a solid hides the sun from a point. */
  bool
  inShadow(const Eigen::Vector3d& point, const Eigen::Vector3d& to_sun) const
  {
    return solids_.blocked({point, to_sun}, 60.0);
  }

private:
  bool nearestGround(const Ray& ray, Surface& surface) const;

  void hitKerb(const Ray& ray, double above, double below, Surface& surface) const;

  std::uint32_t seed_;
  RoadLine road_;
  BoxTree solids_;
};

} // namespace pcl_semantic::synthetic
