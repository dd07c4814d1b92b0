// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/pose_doubts.h>

#include <string>

namespace pcl_semantic {

/** \brief A trajectory as if read from a file in KITTI's format. */
inline StoredTrajectory
storedTrajectory(const Trajectory& poses, const std::string& path = "poses.txt")
{
  StoredTrajectory stored;
  stored.path = path;
  for (const Eigen::Isometry3d& pose : poses)
    stored.poses.push_back({0.0, pose});
  return stored;
}

/** \brief A trajectory as if read from a file in TUM's format. */
inline StoredTrajectory
storedTrajectory(const TimedTrajectory& poses, const std::string& path = "tum.txt")
{
  StoredTrajectory stored;
  stored.path = path;
  stored.format = TrajectoryFormat::tum;
  stored.poses = poses;
  return stored;
}

} // namespace pcl_semantic
