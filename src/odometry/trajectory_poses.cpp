// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/odometry/trajectory_poses.h>

#include "core/fail.h"

#include <pcl_semantic/images/sensor_frame.h>

#include <vector>

namespace pcl_semantic {

std::unique_ptr<PoseSource>
posesOf(const StoredTrajectory& trajectory, const Eigen::Isometry3d& T_camera0_camera,
        double gap)
{
  return std::make_unique<TrajectoryPoses>(
      StoredPoses(trajectory, T_camera0_camera, gap));
}

std::unique_ptr<PoseSource>
readPoses(const std::string& path, const Eigen::Isometry3d& T_camera0_camera,
          double gap, std::vector<std::string>* doubts)
{
  return std::make_unique<TrajectoryPoses>(
      readStoredPoses(path, PoseFrame::first_camera, T_camera0_camera, gap, doubts));
}

std::unique_ptr<PoseSource>
readSensorPoses(const std::string& path, PoseFrame frame, double gap,
                std::vector<std::string>* doubts)
{
  return std::make_unique<TrajectoryPoses>(
      readStoredPoses(path, frame, Eigen::Isometry3d::Identity(), gap, doubts));
}

Eigen::Isometry3d
ViewpointPoses::pose(const SensorFrame& frame)
{
  const auto* const cloud = std::get_if<CloudFrame>(&frame);
  if (!cloud)
    badParameter("got a pair of images, expected a cloud, which has a VIEWPOINT");
  if (!cloud->viewpoint.matrix().allFinite())
    badInput("frame ", cloud->number,
             ": VIEWPOINT has the quaternion 0 0 0 0, expected one of length 1");
  return cloud->viewpoint;
}

} // namespace pcl_semantic
