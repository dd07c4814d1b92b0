// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/odometry/trajectory_poses.h>

#include <gtest/gtest.h>

namespace {

using namespace pcl_semantic;

TEST(TrajectoryPoses, TurnsKittiFramesIntoTheWorld)
{
  // Camera 0 has driven 5 m forward and turned left by 90 degrees; our camera sits
  // 0.06 m to the left of camera 0.
  Trajectory trajectory(2, Eigen::Isometry3d::Identity());
  trajectory[1].translation() << 0.0, 0.0, 5.0;
  trajectory[1].linear() =
      Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity();
  T_camera0_camera.translation() << -0.06, 0.0, 0.0;
  TrajectoryPoses poses(trajectory, T_camera0_camera);

  StereoFrame frame;
  const Eigen::Isometry3d first = poses.pose(frame);
  EXPECT_TRUE(first.translation().isApprox(Eigen::Vector3d(0.0, 0.06, 0.0), 1e-12));
  EXPECT_TRUE(
      (first * Eigen::Vector3d(0, 0, 10)).isApprox(Eigen::Vector3d(10, 0.06, 0)));
  EXPECT_TRUE(
      (first * Eigen::Vector3d(0, 1, 0)).isApprox(Eigen::Vector3d(0, 0.06, -1)));

  frame.number = 1;
  const Eigen::Isometry3d second = poses.pose(frame);
  // What is ahead of the turned camera lies to the left in the world: +y.
  EXPECT_TRUE(
      (second.linear() * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitY()));
  EXPECT_TRUE(second.translation().isApprox(Eigen::Vector3d(4.94, 0.0, 0.0)));
}

TEST(TrajectoryPoses, AFrameWithoutPoseIsNamed)
{
  TrajectoryPoses poses(Trajectory(3, Eigen::Isometry3d::Identity()),
                        Eigen::Isometry3d::Identity(), "poses.txt");
  StereoFrame frame;
  frame.number = 3;
  try {
    poses.pose(frame);
    FAIL() << "a pose was given";
  }
  catch (const BadInputException& error) {
    EXPECT_STREQ(error.what(),
                 "poses.txt: has 3 poses, none for frame 3 (row = frame number)");
  }
}

TEST(TrajectoryPoses, AreAllRequiredBeforeTheFirstFrame)
{
  const TrajectoryPoses poses(Trajectory(3, Eigen::Isometry3d::Identity()),
                              Eigen::Isometry3d::Identity(), "poses.txt");
  poses.requirePoses({{0, 0.0}, {2, 0.2}});
  poses.requirePoses({});
  EXPECT_EQ(thrownMessage<BadInputException>([&] {
              poses.requirePoses({{1, 0.1}, {2, 0.2}, {5, 0.5}, {6, 0.6}});
            }),
            "poses.txt: has 3 poses, none for frame 5 (row = frame number); 2 of 4 "
            "frames lack one");
}

} // namespace
