// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/odometry/pose_file.h>
#include <pcl_semantic/odometry/timed_poses.h>
#include <pcl_semantic/odometry/trajectory_poses.h>

namespace pcl_semantic {

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
