// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>

#include <Eigen/Geometry>

#include <cstdint>
#include <memory>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

namespace synthetic {
class Street;
}

/** \brief The classes of `data/label_sets/kitti11.yaml`, which the synthetic street
 * uses. */
enum SyntheticClass : Label {
  synthetic_building = 1,
  synthetic_sky,
  synthetic_road,
  synthetic_vegetation,
  synthetic_sidewalk,
  synthetic_car,
  synthetic_pedestrian,
  synthetic_cyclist,
  synthetic_sign,
  synthetic_fence,
  synthetic_pole,
  synthetic_classes = 11 ///< how many there are
};

/** \brief Where a ray meets the synthetic street. */
struct SyntheticHit {
  Label label = synthetic_sky;
  double distance = 0.0; ///< in multiples of the ray's direction; infinite for the sky
  Eigen::Vector3d point = Eigen::Vector3d::Zero(); ///< world frame [m]
};

/** \brief A procedural street with turns: road, kerbs, sidewalk, buildings, fences,
 * hedges, trees, poles, signs, parked cars and a few people.
 *
 * World frame: x forward, y left, z up, origin at camera 0 of the first frame, which is
 * camera_height above the road. The camera drives in the right lane. The same seed
 * gives the same street; more frames make it longer and change nothing near its
 * beginning. */
class SyntheticScene {
public:
  static constexpr double camera_height = 1.65;    ///< of camera 0 over the road [m]
  static constexpr double metres_per_frame = 0.85; ///< way along the road
  static constexpr double seconds_per_frame = 0.1;

  /** \param[in] frames how many the street has to be long enough for
   * \throws InvalidParameterException unless 1 <= frames <= 100000 */
  explicit SyntheticScene(std::uint32_t seed, int frames = 40);

  std::uint32_t
  seed() const
  {
    return seed_;
  }

  int
  frames() const
  {
    return frames_;
  }

  /** \brief T_world_camera0 of a frame; camera axes: x right, y down, z forward.
   * \throws InvalidParameterException unless 0 <= frame < frames() */
  Eigen::Isometry3d pose(int frame) const;

  /** \brief The same pose as KITTI writes it: T_first_camera0, the camera 0 of \a frame
   * in the axes of the camera 0 of frame 0. */
  Eigen::Isometry3d kittiPose(int frame) const;

  /** \brief The first surface along origin + distance * direction, world frame. */
  SyntheticHit intersect(const Eigen::Vector3d& origin,
                         const Eigen::Vector3d& direction) const;

  /** \brief What the renderer draws. */
  const synthetic::Street&
  street() const
  {
    return *street_;
  }

private:
  std::uint32_t seed_;
  int frames_;
  std::shared_ptr<const synthetic::Street> street_;
};

} // namespace pcl_semantic
