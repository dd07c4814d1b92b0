/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/odometry/trajectory_poses.h>

namespace pcl_semantic {

TrajectoryPoses::TrajectoryPoses(Trajectory trajectory,
                                 const Eigen::Isometry3d& T_camera0_camera,
                                 std::string name)
    : trajectory_(std::move(trajectory)), T_camera0_camera_(T_camera0_camera),
      name_(std::move(name))
{}

Eigen::Isometry3d
TrajectoryPoses::pose(const StereoFrame& frame)
{
  if (frame.number < 0 || std::size_t(frame.number) >= trajectory_.size())
    PCL_THROW_EXCEPTION(BadInputException, name_ << ": has " << trajectory_.size()
                                                 << " poses, none for frame "
                                                 << frame.number
                                                 << " (row = frame number)");
  return worldFromFirstCamera() * trajectory_[std::size_t(frame.number)] *
         T_camera0_camera_;
}

} // namespace pcl_semantic
