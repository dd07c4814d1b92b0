// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/odometry/pose_source.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Poses from a TUM trajectory, found by the time of a frame. */
class TimedPoses : public PoseSource {
public:
  /** \param[in] trajectory camera-0 poses, see readTumTrajectory
   * \param[in] T_camera0_camera the camera that takes the images, in camera 0
   * \param[in] name its file, for messages
   * \param[in] tolerance how far a pose's time may be from its frame's [s] */
  TimedPoses(TimedTrajectory trajectory, const Eigen::Isometry3d& T_camera0_camera,
             std::string name = "the trajectory", double tolerance = 0.01);

  Eigen::Isometry3d pose(const StereoFrame& frame) override;

  void requirePoses(const std::vector<FrameTime>& frames) const override;

private:
  const TimedPose* find(const FrameTime& frame) const;

  std::string lackOf(const FrameTime& frame) const;

  TimedTrajectory trajectory_;
  Eigen::Isometry3d T_camera0_camera_;
  std::string name_;
  double tolerance_; ///< [s]
};

} // namespace pcl_semantic
