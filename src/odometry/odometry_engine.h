// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "circle_tracker.h"
#include "keyframe_window.h"

#include <pcl_semantic/odometry/stereo_odometry.h>

namespace pcl_semantic {

/** \brief The work behind StereoOdometry; its own world is the first frame's left
 * camera ("first"). */
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
    return lost_frames_;
  }

private:
  void takeImages(const StereoFrame& frame);

  void measureStep(const StereoFrame& frame);

  bool findPose();

  bool tryFrom(const Eigen::Isometry3d& guess);

  int followTracks(const Eigen::Isometry3d& guess,
                   std::vector<odometry::StereoFeature>& now) const;

  void continueFrom(const Eigen::Isometry3d& T_camera_before);

  void restart();

  void addMotion(const Eigen::Isometry3d& motion,
                 const odometry::Matrix6d& motion_covariance);

  void addTracks();

  Parameters parameters_;
  StereoCamera camera_;
  Eigen::Isometry3d T_world_first_;
  odometry::MeasurementNoise noise_;
  odometry::CircleTracker tracker_;
  odometry::KeyframeWindow window_;
  Eigen::Isometry3d T_camera_first_ = Eigen::Isometry3d::Identity(); ///< newest frame
  odometry::Vector6d velocity_ = odometry::Vector6d::Zero(); ///< a second, see log
  double timestamp_ = 0.0;
  double step_ = 0.0; ///< time since the frame before [s]
  int count_ = 0;     ///< frames so far
  int lost_frames_ = 0;
  bool knows_velocity_ = false; ///< measured, so that it predicts
  OdometryResult result_;
};

} // namespace pcl_semantic
