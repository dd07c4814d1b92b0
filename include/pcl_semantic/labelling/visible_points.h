// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/core/sensor_pose.h>
#include <pcl_semantic/core/stereo_camera.h>

#include <Eigen/Geometry>
#include <pcl/point_cloud.h>

#include <limits>
#include <optional>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Which points seenPoints() keeps. The window covers the gaps between the beams
 * of a 64-beam scanner (0.5 degrees) in KITTI's images. */
struct VisibilityParameters {
  double max_depth = 40.0;       ///< camera z [m]
  int window_columns = 3;        ///< half width of the window for occlusion [px]
  int window_rows = 7;           ///< half height of it [px]
  double absolute_margin = 0.5;  ///< nearer by more than this ... [m]
  double relative_margin = 0.05; ///< ... and by more than this fraction of the depth

  /** \throws InvalidParameterException */
  void validate() const;
};

/** \brief The pixel that a point falls on; nothing if it is outside the image or
 * nearer than z = 0.1 m. \param[in] point camera frame [m] */
std::optional<Eigen::Vector2i> pixelOf(const Eigen::Vector3d& point,
                                       const StereoCamera& camera);

/** \brief The points of a scan in the camera's frame [m]; NaN where there was no return
 * (isReturn()).
 * \param[in] T_camera_sensor pose of what took the cloud in the camera
 * \throws BadInputException as requireRigid() */
template <typename PointT>
std::vector<Eigen::Vector3d>
pointsInCamera(const pcl::PointCloud<PointT>& cloud,
               const Eigen::Isometry3d& T_camera_sensor)
{
  requireRigid(T_camera_sensor, "the pose of the sensor in the camera");
  std::vector<Eigen::Vector3d> points;
  points.reserve(cloud.size());
  for (const PointT& point : cloud)
    if (isReturn(point))
      points.push_back(T_camera_sensor *
                       point.getVector3fMap().template cast<double>());
    else
      points.push_back(
          Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  return points;
}

/** \brief Where the camera sees a point. */
struct SeenPoint {
  int row = -1;       ///< of the image [px]
  int column = -1;    ///< likewise
  float depth = 0.0f; ///< camera z [m]; 0 = outside the image, hidden or too far
};

/** \brief Which points of a scan the camera sees.
 *
 * The nearest return of a pixel hides the others, unless they lie as near by one of the
 * margins. The scanner looks from another place than the camera, so returns from behind
 * an object shine through between the returns from the object: a return is hidden if,
 * within the window around its pixel, there are nearer returns (by both margins) both
 * at or above and at or below its row. One side alone does not hide it: the road rises
 * from nearer rows below, and what is seen above a roof is truly seen.
 * \param[in] points of one scan, in the camera's frame [m]; those that are not finite
 * are not seen
 * \param[in] camera pinhole with its image size
 * \return one a point
 * \throws InvalidParameterException unless the image size is known */
std::vector<SeenPoint> seenPoints(const std::vector<Eigen::Vector3d>& points,
                                  const StereoCamera& camera,
                                  const VisibilityParameters& parameters = {});

} // namespace pcl_semantic
