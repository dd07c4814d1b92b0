/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include "circle_tracker.h"
#include "keyframe_window.h"

#include <pcl_semantic/odometry/stereo_odometry.h>

#include <optional>

namespace pcl_semantic {

/** \brief The work behind StereoOdometry; its world is the first frame's left camera. */
class StereoOdometry::Engine {
public:
  Engine(const StereoCamera& camera, const Eigen::Isometry3d& T_camera0_camera,
         const Parameters& parameters);

  const OdometryResult& process(const StereoFrame& frame);

  const OdometryResult&
  result() const
  {
    return result_;
  }

  int
  lostFrames() const
  {
    return lost_;
  }

private:
  void followTracks();

  bool estimatePose();

  void retryLostTracks();

  void finishFrame(bool is_found, const Eigen::Isometry3d& T_camera_before);

  bool wantsKeyframe() const;

  void addTracks();

  Parameters parameters_;
  StereoCamera camera_;
  Eigen::Isometry3d T_world_first_;
  odometry::MeasurementNoise noise_;
  odometry::CircleTracker tracker_;
  odometry::KeyframeWindow window_;
  Eigen::Isometry3d T_camera_first_ = Eigen::Isometry3d::Identity(); ///< newest frame
  odometry::Vector6d velocity_ = odometry::Vector6d::Zero(); ///< in a second
  double timestamp_ = 0.0;
  double step_ = 0.0; ///< time since the frame before [s]
  int count_ = 0; ///< frames so far
  int lost_ = 0;
  OdometryResult result_;
};

} // namespace pcl_semantic
