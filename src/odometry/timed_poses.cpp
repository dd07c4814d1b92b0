/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/odometry/timed_poses.h>

namespace pcl_semantic {

TimedPoses::TimedPoses(TimedTrajectory trajectory,
                       const Eigen::Isometry3d& T_camera0_camera, std::string name,
                       double tolerance)
    : trajectory_(std::move(trajectory)), T_camera0_camera_(T_camera0_camera),
      name_(std::move(name)), tolerance_(tolerance)
{}

Eigen::Isometry3d
TimedPoses::pose(const StereoFrame& frame)
{
  const TimedPose* const found = findPose(trajectory_, frame.timestamp, tolerance_);
  if (!found)
    PCL_THROW_EXCEPTION(BadInputException,
                        name_ << ": has no pose within " << tolerance_ << " s of "
                              << frame.timestamp << " s, the time of frame "
                              << frame.number);
  return worldFromFirstCamera() * found->pose * T_camera0_camera_;
}

} // namespace pcl_semantic
