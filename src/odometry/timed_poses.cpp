// SPDX-License-Identifier: BSD-3-Clause
#include "missing_poses.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/odometry/timed_poses.h>

#include <locale>
#include <sstream>

namespace pcl_semantic {

TimedPoses::TimedPoses(TimedTrajectory trajectory,
                       const Eigen::Isometry3d& T_camera0_camera, std::string name,
                       double tolerance)
    : trajectory_(std::move(trajectory)), T_camera0_camera_(T_camera0_camera),
      name_(std::move(name)), tolerance_(tolerance)
{}

const TimedPose*
TimedPoses::find(const FrameTime& frame) const
{
  return findPose(trajectory_, frame.timestamp, tolerance_);
}

std::string
TimedPoses::lackOf(const FrameTime& frame) const
{
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(15); // times may be of the Unix clock
  text << name_ << ": has no pose within " << tolerance_ << " s of " << frame.timestamp
       << " s, the time of frame " << frame.number;
  if (!trajectory_.empty())
    text << "; its times are from " << trajectory_.front().time << " to "
         << trajectory_.back().time << " s";
  return text.str();
}

Eigen::Isometry3d
TimedPoses::pose(const StereoFrame& frame)
{
  const FrameTime time{frame.number, frame.timestamp};
  const TimedPose* const found = find(time);
  if (!found)
    PCL_THROW_EXCEPTION(BadInputException, lackOf(time));
  return worldFromFirstCamera() * found->pose * T_camera0_camera_;
}

void
TimedPoses::requirePoses(const std::vector<FrameTime>& frames) const
{
  requireNoneLacks(
      frames, [&](const FrameTime& frame) { return !find(frame); },
      [&](const FrameTime& frame) { return lackOf(frame); });
}

} // namespace pcl_semantic
