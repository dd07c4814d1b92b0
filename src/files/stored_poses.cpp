// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/stored_poses.h>

#include "core/fail.h"
#include "core/text_stream.h"

#include <pcl_semantic/core/sensor_pose.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcl_semantic {

namespace {

constexpr double kSameTime = 1e-5;  // rounding of a written time [s]
constexpr double kTolerance = 0.01; // between the times of pose and frame [s]

Eigen::Isometry3d
interpolated(const TimedPose& before, const TimedPose& after, double time)
{
  const double weight = (time - before.time) / (after.time - before.time);
  const Eigen::Quaterniond first(before.pose.linear()), last(after.pose.linear());
  const double sign = first.dot(last) < 0.0 ? -1.0 : 1.0;
  // Without slerp()'s sines, which are not the same on every platform.
  const Eigen::Quaterniond between((1.0 - weight) * first.coeffs() +
                                   weight * sign * last.coeffs());
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = between.normalized().toRotationMatrix();
  pose.translation() =
      (1.0 - weight) * before.pose.translation() + weight * after.pose.translation();
  return pose;
}

} // namespace

StoredPoses::StoredPoses(StoredTrajectory trajectory,
                         const Eigen::Isometry3d& T_camera0_camera, double gap)
    : trajectory_(std::move(trajectory)), T_camera0_camera_(T_camera0_camera), gap_(gap)
{
  if (!(gap >= 0.0 && std::isfinite(gap)))
    badParameter("the gap between interpolated poses is ", gap,
                 " s, expected 0 or more");
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
  const std::optional<Eigen::Isometry3d> found = find(frame);
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

std::optional<Eigen::Isometry3d>
StoredPoses::find(const FrameTime& frame) const
{
  const TimedTrajectory& poses = trajectory_.poses;
  if (trajectory_.format == TrajectoryFormat::tum)
    return at(frame.timestamp);
  if (frame.number < 0 || std::size_t(frame.number) >= poses.size())
    return std::nullopt;
  const Eigen::Isometry3d& pose = poses[std::size_t(frame.number)].pose;
  return pose.matrix().allFinite() ? std::optional(pose) : std::nullopt;
}

std::optional<Eigen::Isometry3d>
StoredPoses::at(double time) const
{
  const TimedTrajectory& poses = trajectory_.poses;
  if (const TimedPose* const same = findPose(poses, time, kSameTime))
    return same->pose;
  const auto after = std::upper_bound(
      poses.begin(), poses.end(), time,
      [](double value, const TimedPose& timed) { return value < timed.time; });
  if (after != poses.begin() && after != poses.end() && gap_ > 0.0 &&
      after->time - (after - 1)->time <= gap_ + kSameTime)
    return interpolated(*(after - 1), *after, time);
  const TimedPose* const nearest = findPose(poses, time, kTolerance);
  return nearest ? std::optional<Eigen::Isometry3d>(nearest->pose) : std::nullopt;
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
  text << "no pose within " << kTolerance << " s of " << frame.timestamp
       << " s, the time of frame " << frame.number << ", nor two around it within "
       << gap_ << " s";
  if (!poses.empty())
    text << "; its times are from " << poses.front().time << " to " << poses.back().time
         << " s";
  return text.str();
}

StoredPoses
readStoredPoses(const std::string& path, PoseFrame frame,
                const Eigen::Isometry3d& T_camera0_camera, double gap,
                std::vector<std::string>* doubts)
{
  StoredTrajectory read = readTrajectory(path, frame);
  if (doubts)
    doubts->insert(doubts->end(), read.doubts.begin(), read.doubts.end());
  return StoredPoses(std::move(read), T_camera0_camera, gap);
}

} // namespace pcl_semantic
