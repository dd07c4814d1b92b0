// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/sensor_frame.h>
#include <pcl_semantic/odometry/trajectory_poses.h>

#include <algorithm>
#include <locale>
#include <sstream>
#include <vector>

namespace pcl_semantic {

/** \brief The check of PoseSource::requirePoses().
 * \param[in] lacks tells whether a frame has no pose
 * \param[in] lackOf says so of a frame
 * \throws BadInputException */
template <typename Lacks, typename LackOf>
void
requireNoneLacks(const std::vector<FrameTime>& frames, const Lacks& lacks,
                 const LackOf& lackOf)
{
  const auto first = std::find_if(frames.begin(), frames.end(), lacks);
  if (first != frames.end())
    PCL_THROW_EXCEPTION(BadInputException,
                        lackOf(*first)
                            << "; " << std::count_if(first, frames.end(), lacks)
                            << " of " << frames.size() << " frames lack one");
}

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
TimedPoses::pose(const SensorFrame& frame)
{
  const FrameTime& time = timeOf(frame);
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
TrajectoryPoses::pose(const SensorFrame& frame)
{
  const FrameTime& time = timeOf(frame);
  if (!has(time))
    PCL_THROW_EXCEPTION(BadInputException, lackOf(time));
  return worldFromFirstCamera() * trajectory_[std::size_t(time.number)] *
         T_camera0_camera_;
}

void
TrajectoryPoses::requirePoses(const std::vector<FrameTime>& frames) const
{
  requireNoneLacks(
      frames, [&](const FrameTime& frame) { return !has(frame); },
      [&](const FrameTime& frame) { return lackOf(frame); });
}

namespace {

// The poses T_world_camera = worldFromFirstCamera() T_first_file POSE T_camera0_camera.
std::unique_ptr<PoseSource>
readTurned(const std::string& path, const Eigen::Isometry3d& T_first_file,
           const Eigen::Isometry3d& T_camera0_camera)
{
  if (trajectoryFormatOf(path) == TrajectoryFormat::tum) {
    TimedTrajectory timed = readTumTrajectory(path);
    for (TimedPose& each : timed)
      each.pose = T_first_file * each.pose;
    return std::make_unique<TimedPoses>(std::move(timed), T_camera0_camera, path);
  }
  Trajectory poses = readKittiTrajectory(path);
  for (Eigen::Isometry3d& pose : poses)
    pose = T_first_file * pose;
  return std::make_unique<TrajectoryPoses>(std::move(poses), T_camera0_camera, path);
}

} // namespace

std::unique_ptr<PoseSource>
readPoses(const std::string& path, const Eigen::Isometry3d& T_camera0_camera)
{
  return readTurned(path, Eigen::Isometry3d::Identity(), T_camera0_camera);
}

std::unique_ptr<PoseSource>
readSensorPoses(const std::string& path)
{
  return readTurned(path, worldFromFirstCamera().inverse(),
                    Eigen::Isometry3d::Identity());
}

} // namespace pcl_semantic
