// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "noise.h"
#include "surface.h"

#include <memory>
#include <vector>

namespace pcl_semantic {

/** \brief The classes of `data/label_sets/kitti11.yaml`, which the street uses. */
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
  synthetic_classes = 11 ///< number of classes
};

struct DrivingCar;

} // namespace pcl_semantic

namespace pcl_semantic::synthetic {

/** \brief The centre line of the road: straight sections and arcs that turn alternately
 * left and right, so that it never crosses itself. */
class RoadLine {
public:
  static constexpr double half_width = 5.2;   ///< centre line to kerb [m]
  static constexpr double sidewalk_end = 7.7; ///< centre line to the plots [m]
  static constexpr double kerb_height = 0.14; ///< of the sidewalk above the road [m]

  /** \param[in] start position of s = 0, world frame; the first section runs along +x
   * \param[in] length smallest length of the line [m] */
  RoadLine(const Eigen::Vector2d& start, double length, std::uint32_t seed);

  /** \brief World position of a road point. */
  Eigen::Vector2d position(const RoadPoint& point) const;

  /** \brief Direction of the line at \a s: angle from +x to the left [rad]. */
  double heading(double s) const;

  /** \brief Curvature at \a s, positive to the left [1/m]. */
  double curvature(double s) const;

  /** \brief The road point nearest to a world position. */
  RoadPoint locate(const Eigen::Vector2d& position) const;

private:
  struct Piece {
    double s = 0.0;         ///< at its start
    double length = 0.0;    ///< [m]
    double curvature = 0.0; ///< [1/m], left positive
    double heading = 0.0;   ///< at its start [rad]
    Eigen::Vector2d start;  ///< world position of its start
    Eigen::Vector2d along;  ///< unit vector of heading
  };

  void append(double length, double curvature);

  const Piece& pieceAt(double s) const;

  RoadPoint locateOn(const Piece& piece, const Eigen::Vector2d& position) const;

  std::vector<Piece> pieces_;
};

/** \brief Geometry of the street in one frame: the ground along the road line, and all
 * solids on it. Copies share the solids that stand. */
class Street {
public:
  static constexpr double road_height = -1.65; ///< z of the road, world frame [m]
  static constexpr double lane = -1.6;         ///< t of the camera's lane [m]
  static constexpr double sight = 400.0;       ///< limit of the ground [m]

  /** \brief Makes the street without driving cars.
   * \param[in] length distance driven by the camera [m]
   * \param[in] first_object number of the first standing object */
  Street(std::uint32_t seed, double length, int first_object = 1);

  /** \brief The same street with driving cars, as in a frame. */
  Street withTraffic(const std::vector<DrivingCar>& traffic, int frame) const;

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

  /** \brief The solids that stand. */
  const std::vector<Primitive>&
  standing() const
  {
    return standing_->primitives();
  }

  /** \brief The solids of the driving cars. */
  const std::vector<Primitive>&
  driving() const
  {
    return driving_.primitives();
  }

  /** \brief Finds the first surface along a ray. \return false for the sky */
  bool nearest(const Ray& ray, Surface& surface) const;

  /** \brief Whether a solid hides the sun from a point. */
  bool
  inShadow(const Eigen::Vector3d& point, const Eigen::Vector3d& to_sun) const
  {
    return standing_->blocked({point, to_sun}, 60.0) ||
           driving_.blocked({point, to_sun}, 60.0);
  }

private:
  bool nearestGround(const Ray& ray, Surface& surface) const;

  void hitKerb(const Ray& ray, double above, double below, Surface& surface) const;

  std::uint32_t seed_;
  double length_; ///< of the built part of the road [m]
  RoadLine road_;
  std::shared_ptr<const BoxTree> standing_;
  BoxTree driving_;
};

} // namespace pcl_semantic::synthetic

namespace pcl_semantic {

/** \brief A car that drives along the road with a constant speed. Right of the centre
 * line it faces along the road, and left of it against the road. Its size and its
 * colours depend on the seed of the street and on its index in the traffic. */
struct DrivingCar {
  synthetic::RoadPoint start; ///< centre of the car in frame 0
  double speed = 0.0;         ///< change of s [m/frame]; negative for an oncoming car
};

/** \brief Places cars alternately in the camera's lane, slightly faster than the
 * camera, and in the other lane, towards the camera.
 * \throws InvalidParameterException unless 0 <= cars <= 1000 */
std::vector<DrivingCar> makeTraffic(int cars);

/** \brief A car in one frame. */
struct SyntheticCar {
  int object = 0;                          ///< number in SyntheticView::objects
  bool is_driving = false;                 ///< whether it is one of the DrivingCars
  std::vector<synthetic::Primitive> parts; ///< world frame [m]

  /** \brief Distance from a point in the world frame to the boxes around its parts
   * [m]; 0 inside. */
  double distance(const Eigen::Vector3d& point) const;
};

/** \brief Point at which a ray meets the street. */
struct SyntheticHit {
  Label label = synthetic_sky;
  double distance = 0.0; ///< in multiples of the ray's direction; infinite for the sky
  Eigen::Vector3d point = Eigen::Vector3d::Zero(); ///< world frame [m]
};

/** \brief A procedural street with turns: road, kerbs, sidewalk, buildings, fences,
 * hedges, trees, poles, signs, parked cars and a few people. Cars may drive on it.
 *
 * World frame: x forward, y left, z up, origin at camera 0 of the first frame, which is
 * camera_height above the road. The camera drives in the right lane. The same seed
 * gives the same street. More frames extend the street without changes near its
 * start. */
class SyntheticScene {
public:
  static constexpr double camera_height = 1.65;    ///< of camera 0 above the road [m]
  static constexpr double metres_per_frame = 0.85; ///< distance along the road
  static constexpr double seconds_per_frame = 0.1;

  /** \param[in] frames number of frames that the street must be long enough for
   * \param[in] traffic cars that drive; a car beyond the end of the built street is
   * absent
   * \throws InvalidParameterException unless 1 <= frames <= 100000, or if a position or
   * a speed is not finite */
  explicit SyntheticScene(std::uint32_t seed, int frames = 40,
                          std::vector<DrivingCar> traffic = {});

  std::uint32_t
  seed() const
  {
    return street_->seed();
  }

  int
  frames() const
  {
    return frames_;
  }

  /** \brief T_world_camera0 of a frame; camera axes: x right, y down, z forward.
   * \throws InvalidParameterException unless 0 <= frame < frames() */
  Eigen::Isometry3d pose(int frame) const;

  /** \brief The same pose in KITTI's convention: T_first_camera0, camera 0 of \a frame
   * in the axes of camera 0 of frame 0. */
  Eigen::Isometry3d kittiPose(int frame) const;

  /** \brief Finds the first surface along origin + distance * direction, world frame,
   * without driving cars. */
  SyntheticHit intersect(const Eigen::Vector3d& origin,
                         const Eigen::Vector3d& direction) const;

  /** \brief The rendered geometry of a frame. \throws as pose() */
  synthetic::Street street(int frame) const;

  /** \brief All cars of a frame, in the order of their numbers. The driving cars have
   * the numbers from 1, in the order of the traffic. \throws as pose() */
  std::vector<SyntheticCar> cars(int frame) const;

private:
  void checkFrame(int frame) const;

  int frames_;
  std::vector<DrivingCar> traffic_;
  std::shared_ptr<const synthetic::Street> street_;
};

} // namespace pcl_semantic
