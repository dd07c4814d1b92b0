// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/odometry/pose_source.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Poses from a KITTI trajectory: row n is the pose of camera 0 at frame n. */
class TrajectoryPoses : public PoseSource {
public:
  /** \param[in] trajectory camera-0 poses, see readKittiTrajectory
   * \param[in] T_camera0_camera the camera that takes the images, in camera 0
   * \param[in] name its file, for messages */
  TrajectoryPoses(Trajectory trajectory, const Eigen::Isometry3d& T_camera0_camera,
                  std::string name = "the trajectory");

  Eigen::Isometry3d pose(const StereoFrame& frame) override;

  void requirePoses(const std::vector<FrameTime>& frames) const override;

private:
  bool has(const FrameTime& frame) const;

  std::string lackOf(const FrameTime& frame) const;

  Trajectory trajectory_;
  Eigen::Isometry3d T_camera0_camera_;
  std::string name_;
};

} // namespace pcl_semantic
