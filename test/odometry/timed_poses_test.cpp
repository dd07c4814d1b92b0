// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
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
    const StereoFrame frame{{i, 0.1 * i}, {}, {}};
    EXPECT_EQ(by_time.pose(frame).matrix(), by_row.pose(frame).matrix());
  }
}

TEST(TimedPoses, AFrameWithoutPoseIsNamed)
{
  TimedPoses poses({{1.0, Eigen::Isometry3d::Identity()}},
                   Eigen::Isometry3d::Identity(), "tum.txt");
  try {
    poses.pose(StereoFrame{{7, 1.02}, {}, {}});
    FAIL() << "a pose was given";
  }
  catch (const BadInputException& error) {
    EXPECT_STREQ(
        error.what(),
        "tum.txt: has no pose within 0.01 s of 1.02 s, the time of frame 7; its "
        "times are from 1 to 1 s");
  }
}

TEST(TimedPoses, AreAllRequiredBeforeTheFirstFrame)
{
  const double start = 1403636579.763555584; // as ORB-SLAM writes EuRoC's
  TimedTrajectory trajectory(4);
  for (const int i : {0, 1, 2, 3})
    trajectory[std::size_t(i)].time = start + (i < 2 ? 0.05 * i : 0.05 * (i + 1));
  const TimedPoses poses(trajectory, Eigen::Isometry3d::Identity(), "tum.txt");
  std::vector<FrameTime> frames;
  for (const int i : {0, 1, 3, 4})
    frames.push_back({10 + i, start + 0.05 * i});
  poses.requirePoses(frames);
  poses.requirePoses({});
  frames.push_back({12, start + 0.1}); // lost in the middle
  frames.push_back({15, start + 0.25});
  EXPECT_EQ(
      thrownMessage<BadInputException>([&] { poses.requirePoses(frames); }),
      "tum.txt: has no pose within 0.01 s of 1403636579.86356 s, the time of frame 12; "
      "its times are from 1403636579.76356 to 1403636579.96356 s; 2 of 6 frames lack "
      "one");
}

} // namespace
