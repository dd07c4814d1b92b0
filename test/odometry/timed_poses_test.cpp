/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/odometry/timed_poses.h>
#include <pcl_semantic/odometry/trajectory_poses.h>

#include <gtest/gtest.h>

namespace {

using namespace pcl_semantic;

TEST(TimedPoses, AreThoseOfTheSameTrajectoryByRow)
{
  Trajectory rows(3, Eigen::Isometry3d::Identity());
  TimedTrajectory timed;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].translation() << 0.1 * double(i), 0.2, double(i);
    timed.push_back({0.1 * double(i) + 0.004, rows[i]});
  }
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity();
  T_camera0_camera.translation().x() = -0.06;
  TimedPoses by_time(timed, T_camera0_camera);
  TrajectoryPoses by_row(rows, T_camera0_camera);
  for (int i = 0; i < 3; ++i) {
    const StereoFrame frame{i, 0.1 * i, {}, {}};
    EXPECT_EQ(by_time.pose(frame).matrix(), by_row.pose(frame).matrix());
  }
}

TEST(TimedPoses, AFrameWithoutPoseIsNamed)
{
  TimedPoses poses({{1.0, Eigen::Isometry3d::Identity()}},
                   Eigen::Isometry3d::Identity(), "tum.txt");
  try {
    poses.pose({7, 1.02, {}, {}});
    FAIL() << "a pose was given";
  }
  catch (const BadInputException& error) {
    EXPECT_STREQ(error.what(),
                 "tum.txt: has no pose within 0.01 s of 1.02 s, the time of frame 7");
  }
}

} // namespace
