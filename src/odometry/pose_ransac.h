// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stereo_projection.h"

#include <vector>

namespace pcl_semantic::odometry {

/** \brief A point in the world and its measurement in the frame. */
struct PoseMeasurement {
  AnchoredPoint
      position; ///< ray of any length in the world's axes, and inverse depth along it
  Eigen::Vector3d uvd = Eigen::Vector3d::Zero(); ///< column, row, disparity [px]
};

/** \brief Estimates the pose with the most inliers (RANSAC over three points, each
 * sample solved by Gauss-Newton from the predicted pose) and refines it over them.
 * \param[in,out] T_camera_world predicted, then estimated pose
 * \return one flag per measurement: whether it is an inlier */
std::vector<char> estimatePose(const StereoCamera& camera,
                               const MeasurementNoise& noise,
                               const std::vector<PoseMeasurement>& measurements,
                               Eigen::Isometry3d& T_camera_world);

} // namespace pcl_semantic::odometry
