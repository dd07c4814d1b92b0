// SPDX-License-Identifier: BSD-3-Clause
#include "missing_poses.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/odometry/trajectory_poses.h>

namespace pcl_semantic {

TrajectoryPoses::TrajectoryPoses(Trajectory trajectory,
                                 const Eigen::Isometry3d& T_camera0_camera,
                                 std::string name)
    : trajectory_(std::move(trajectory)), T_camera0_camera_(T_camera0_camera),
      name_(std::move(name))
{}

bool
TrajectoryPoses::has(const FrameTime& frame) const
{
  return frame.number >= 0 && std::size_t(frame.number) < trajectory_.size();
}

std::string
TrajectoryPoses::lackOf(const FrameTime& frame) const
{
  return name_ + ": has " + std::to_string(trajectory_.size()) +
         " poses, none for frame " + std::to_string(frame.number) +
         " (row = frame number)";
}

Eigen::Isometry3d
TrajectoryPoses::pose(const StereoFrame& frame)
{
  const FrameTime time{frame.number, frame.timestamp};
  if (!has(time))
    PCL_THROW_EXCEPTION(BadInputException, lackOf(time));
  return worldFromFirstCamera() * trajectory_[std::size_t(frame.number)] *
         T_camera0_camera_;
}

void
TrajectoryPoses::requirePoses(const std::vector<FrameTime>& frames) const
{
  requireNoneLacks(
      frames, [&](const FrameTime& frame) { return !has(frame); },
      [&](const FrameTime& frame) { return lackOf(frame); });
}

} // namespace pcl_semantic
