/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/odometry/pose_file.h>
#include <pcl_semantic/odometry/timed_poses.h>
#include <pcl_semantic/odometry/trajectory_poses.h>

namespace pcl_semantic {

std::unique_ptr<PoseSource>
readPoses(const std::string& path, const Eigen::Isometry3d& T_camera0_camera)
{
  if (trajectoryFormatOf(path) == TrajectoryFormat::tum)
    return std::make_unique<TimedPoses>(readTumTrajectory(path), T_camera0_camera,
                                        path);
  return std::make_unique<TrajectoryPoses>(readKittiTrajectory(path), T_camera0_camera,
                                           path);
}

} // namespace pcl_semantic
