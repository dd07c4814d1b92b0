// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/odometry/trajectory_poses.h>

#include "core/fail.h"

#include <pcl_semantic/core/sensor_pose.h>
#include <pcl_semantic/images/sensor_frame.h>

#include <algorithm>
#include <vector>

namespace pcl_semantic {

StoredPoses::StoredPoses(const Eigen::Isometry3d& T_camera0_camera, std::string name)
    : name_(std::move(name)), T_camera0_camera_(T_camera0_camera)
{
  requireRigid(T_camera0_camera, name_ + ": the pose of the camera in camera 0");
}

Eigen::Isometry3d
StoredPoses::pose(const SensorFrame& frame)
{
  const FrameTime& time = timeOf(frame);
  const Eigen::Isometry3d* const found = find(time);
  if (!found)
    badInput(lackOf(time));
  requireRigid(*found, name_ + ": the pose of frame " + std::to_string(time.number));
  return worldFromFirstCamera() * *found * T_camera0_camera_;
}

void
StoredPoses::requirePoses(const std::vector<FrameTime>& frames) const
{
  const auto lacks = [&](const FrameTime& frame) { return !find(frame); };
  const auto first = std::find_if(frames.begin(), frames.end(), lacks);
  if (first != frames.end())
    badInput(lackOf(*first), "; ", std::count_if(first, frames.end(), lacks), " of ",
             frames.size(), " frames lack one");
}

TimedPoses::TimedPoses(TimedTrajectory trajectory,
                       const Eigen::Isometry3d& T_camera0_camera, std::string name,
                       double tolerance)
    : StoredPoses(T_camera0_camera, std::move(name)),
      trajectory_(std::move(trajectory)), tolerance_(tolerance)
{}

const Eigen::Isometry3d*
TimedPoses::find(const FrameTime& frame) const
{
  const TimedPose* const found = findPose(trajectory_, frame.timestamp, tolerance_);
  return found ? &found->pose : nullptr;
}

std::string
TimedPoses::lackOf(const FrameTime& frame) const
{
  TextStream text;
  text.precision(15); // times may be of the Unix clock
  text << name_ << ": has no pose within " << tolerance_ << " s of " << frame.timestamp
       << " s, the time of frame " << frame.number;
  if (!trajectory_.empty())
    text << "; its times are from " << trajectory_.front().time << " to "
         << trajectory_.back().time << " s";
  return text.str();
}

TrajectoryPoses::TrajectoryPoses(Trajectory trajectory,
                                 const Eigen::Isometry3d& T_camera0_camera,
                                 std::string name)
    : StoredPoses(T_camera0_camera, std::move(name)), trajectory_(std::move(trajectory))
{}

const Eigen::Isometry3d*
TrajectoryPoses::find(const FrameTime& frame) const
{
  const bool is_there =
      frame.number >= 0 && std::size_t(frame.number) < trajectory_.size();
  return is_there ? &trajectory_[std::size_t(frame.number)] : nullptr;
}

std::string
TrajectoryPoses::lackOf(const FrameTime& frame) const
{
  return name_ + ": has " + std::to_string(trajectory_.size()) +
         " poses, none for frame " + std::to_string(frame.number) +
         " (row = frame number)";
}

std::unique_ptr<PoseSource>
posesOf(const StoredTrajectory& trajectory, const Eigen::Isometry3d& T_camera0_camera)
{
  // T_world_camera = worldFromFirstCamera() T_first_file POSE T_camera0_camera
  Eigen::Isometry3d T_first_file = Eigen::Isometry3d::Identity();
  if (trajectory.frame != PoseFrame::first_camera)
    T_first_file = worldFromFirstCamera().inverse();
  TimedTrajectory timed = trajectory.poses;
  for (TimedPose& each : timed)
    each.pose = T_first_file * each.pose;
  if (trajectory.format == TrajectoryFormat::tum)
    return std::make_unique<TimedPoses>(std::move(timed), T_camera0_camera,
                                        trajectory.path);
  Trajectory poses;
  for (const TimedPose& each : timed)
    poses.push_back(each.pose);
  return std::make_unique<TrajectoryPoses>(std::move(poses), T_camera0_camera,
                                           trajectory.path);
}

namespace {

std::unique_ptr<PoseSource>
readPosesOf(const std::string& path, PoseFrame frame,
            const Eigen::Isometry3d& T_camera0_camera, std::vector<std::string>* doubts)
{
  const StoredTrajectory read = readTrajectory(path, frame);
  if (doubts)
    doubts->insert(doubts->end(), read.doubts.begin(), read.doubts.end());
  return posesOf(read, T_camera0_camera);
}

} // namespace

std::unique_ptr<PoseSource>
readPoses(const std::string& path, const Eigen::Isometry3d& T_camera0_camera,
          std::vector<std::string>* doubts)
{
  return readPosesOf(path, PoseFrame::first_camera, T_camera0_camera, doubts);
}

std::unique_ptr<PoseSource>
readSensorPoses(const std::string& path, PoseFrame frame,
                std::vector<std::string>* doubts)
{
  return readPosesOf(path, frame, Eigen::Isometry3d::Identity(), doubts);
}

Eigen::Isometry3d
ViewpointPoses::pose(const SensorFrame& frame)
{
  const auto* const cloud = std::get_if<CloudFrame>(&frame);
  if (!cloud)
    badParameter("a pair of images brings no pose, as clouds do");
  if (!cloud->viewpoint.matrix().allFinite())
    badInput("frame ", cloud->number,
             ": VIEWPOINT has the quaternion 0 0 0 0, expected one of length 1");
  return cloud->viewpoint;
}

} // namespace pcl_semantic
