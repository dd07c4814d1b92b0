// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/stored_poses.h>

#include "core/fail.h"
#include "core/text_stream.h"

#include <pcl_semantic/core/sensor_pose.h>

#include <algorithm>
#include <utility>

namespace pcl_semantic {

StoredPoses::StoredPoses(StoredTrajectory trajectory,
                         const Eigen::Isometry3d& T_camera0_camera, double tolerance)
    : trajectory_(std::move(trajectory)), T_camera0_camera_(T_camera0_camera),
      tolerance_(tolerance)
{
  requireRigid(T_camera0_camera,
               trajectory_.path + ": the pose of the camera in camera 0");
  // T_world_camera = worldFromFirstCamera() T_first_file POSE T_camera0_camera
  Eigen::Isometry3d T_first_file = Eigen::Isometry3d::Identity();
  if (trajectory_.frame != PoseFrame::first_camera)
    T_first_file = worldFromFirstCamera().inverse();
  for (TimedPose& each : trajectory_.poses)
    each.pose = T_first_file * each.pose;
}

Eigen::Isometry3d
StoredPoses::pose(const FrameTime& frame) const
{
  const Eigen::Isometry3d* const found = find(frame);
  if (!found)
    badInput(lackOf(frame));
  requireRigid(*found, trajectory_.path + ": the pose of frame " +
                           std::to_string(frame.number));
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

const Eigen::Isometry3d*
StoredPoses::find(const FrameTime& frame) const
{
  const TimedTrajectory& poses = trajectory_.poses;
  if (trajectory_.format == TrajectoryFormat::tum) {
    const TimedPose* const found = findPose(poses, frame.timestamp, tolerance_);
    return found ? &found->pose : nullptr;
  }
  const bool is_there = frame.number >= 0 && std::size_t(frame.number) < poses.size();
  return is_there ? &poses[std::size_t(frame.number)].pose : nullptr;
}

std::string
StoredPoses::lackOf(const FrameTime& frame) const
{
  const TimedTrajectory& poses = trajectory_.poses;
  TextStream text;
  text.precision(15); // enough for Unix time
  text << trajectory_.path << ": has ";
  if (trajectory_.format == TrajectoryFormat::kitti) {
    text << poses.size() << " poses, none for frame " << frame.number
         << " (row = frame number)";
    return text.str();
  }
  text << "no pose within " << tolerance_ << " s of " << frame.timestamp
       << " s, the time of frame " << frame.number;
  if (!poses.empty())
    text << "; its times are from " << poses.front().time << " to " << poses.back().time
         << " s";
  return text.str();
}

StoredPoses
readStoredPoses(const std::string& path, PoseFrame frame,
                const Eigen::Isometry3d& T_camera0_camera,
                std::vector<std::string>* doubts)
{
  StoredTrajectory read = readTrajectory(path, frame);
  if (doubts)
    doubts->insert(doubts->end(), read.doubts.begin(), read.doubts.end());
  return StoredPoses(std::move(read), T_camera0_camera);
}

} // namespace pcl_semantic
