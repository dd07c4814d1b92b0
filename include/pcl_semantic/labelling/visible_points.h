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

/** \brief Parameters of seenPoints(). The default window covers the gaps between the
 * beams of a 64-beam scanner (0.5 degrees) in KITTI's images. */
struct VisibilityParameters {
  double max_depth = 40.0;       ///< camera z [m]
  int window_columns = 3;        ///< half width of the window for occlusion [px]
  int window_rows = 7;           ///< half height of the window [px]
  double absolute_margin = 0.5;  ///< nearer by more than this ... [m]
  double relative_margin = 0.05; ///< ... and by more than this fraction of the depth

  /** \throws InvalidParameterException that names the parameter and its range */
  void validate() const;
};

/** \brief Pixel of a point; none outside the image or nearer than z = 0.1 m.
 * \param[in] point camera frame [m] */
std::optional<Eigen::Vector2i> pixelOf(const Eigen::Vector3d& point,
                                       const StereoCamera& camera);

/** \brief Transforms a scan to the camera's frame [m]; NaN for no-returns (isReturn()).
 * \param[in] T_camera_sensor pose of the scanner in the camera
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

/** \brief Position of a point in the image. */
struct SeenPoint {
  int row = -1;       ///< image row [px]
  int column = -1;    ///< image column [px]
  float depth = 0.0f; ///< camera z [m]; 0 = outside the image, hidden or too far
};

/** \brief Projects a scan into the camera and finds the visible points.
 *
 * The nearest return of a pixel hides the others, unless they are within one of the
 * margins. Scanner and camera have different positions, so returns from behind an
 * object appear between the returns from the object. Therefore a return is hidden if
 * the window around its pixel contains nearer returns (by both margins) both at or
 * above and at or below its row. One side is not enough: the road rises from nearer
 * rows below, and points above a roof are visible.
 * \param[in] points of one scan, in the camera's frame [m]; points that are not finite
 * are invisible
 * \param[in] camera pinhole with its image size
 * \return one per point
 * \throws InvalidParameterException if the image size is unknown */
std::vector<SeenPoint> seenPoints(const std::vector<Eigen::Vector3d>& points,
                                  const StereoCamera& camera,
                                  const VisibilityParameters& parameters = {});

} // namespace pcl_semantic
