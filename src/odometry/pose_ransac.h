// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stereo_projection.h"

#include <cstdint>
#include <vector>

namespace pcl_semantic::odometry {

/** \brief A point in the world and where the frame sees it. */
struct PoseMeasurement {
  AnchoredPoint
      position; ///< its ray in the world's axes, of any length, times 1 / depth
  Eigen::Vector3d uvd = Eigen::Vector3d::Zero(); ///< column, row, disparity [px]
};

/** \brief The pose that most measurements agree with (RANSAC over three points, each
 * tried by Gauss-Newton from the predicted pose), refined over those. */
class PoseRansac {
public:
  PoseRansac(const StereoCamera& camera, const MeasurementNoise& noise)
      : camera_(camera), noise_(noise)
  {}

  int trials = 60;        ///< at most
  double threshold = 2.0; ///< residual of an inlier [px]
  std::uint32_t seed = 1;

  /** \param[in,out] T_camera_world the predicted pose, then the one found
   * \return a flag for each measurement: whether it agrees */
  std::vector<char> estimate(const std::vector<PoseMeasurement>& measurements,
                             Eigen::Isometry3d& T_camera_world) const;

private:
  bool agrees(const PoseMeasurement& measurement,
              const Eigen::Isometry3d& T_camera_world) const;

  bool refine(const std::vector<const PoseMeasurement*>& measurements, int iterations,
              Eigen::Isometry3d& T_camera_world) const;

  Eigen::Isometry3d bestOfSamples(const std::vector<PoseMeasurement>& measurements,
                                  const Eigen::Isometry3d& predicted) const;

  StereoCamera camera_;
  MeasurementNoise noise_;
};

} // namespace pcl_semantic::odometry
