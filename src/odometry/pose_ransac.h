// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stereo_projection.h"

#include <vector>

namespace pcl_semantic::odometry {

/** \brief A point in the world and where the frame sees it. */
struct PoseMeasurement {
  AnchoredPoint
      position; ///< its ray in the world's axes, of any length, times 1 / depth
  Eigen::Vector3d uvd = Eigen::Vector3d::Zero(); ///< column, row, disparity [px]
};

/** \brief The pose that most measurements agree with (RANSAC over three points, each
 * tried by Gauss-Newton from the predicted pose), refined over those.
 * \param[in,out] T_camera_world the predicted pose, then the one found
 * \return a flag for each measurement: whether it agrees */
std::vector<char> estimatePose(const StereoCamera& camera,
                               const MeasurementNoise& noise,
                               const std::vector<PoseMeasurement>& measurements,
                               Eigen::Isometry3d& T_camera_world);

} // namespace pcl_semantic::odometry
