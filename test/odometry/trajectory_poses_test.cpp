// SPDX-License-Identifier: BSD-3-Clause
#include "support/stored_trajectory.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/odometry/trajectory_poses.h>

#include <gtest/gtest.h>

namespace {

using namespace pcl_semantic;

StereoFrame
frameOf(int number, double time)
{
  return {{number, time}, {}, {}};
}

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
  TrajectoryPoses poses(StoredPoses(storedTrajectory(trajectory), T_camera0_camera));

  const Eigen::Isometry3d first = poses.pose(frameOf(0, 0.0));
  EXPECT_TRUE(first.translation().isApprox(Eigen::Vector3d(0.0, 0.06, 0.0), 1e-12));
  EXPECT_TRUE(
      (first * Eigen::Vector3d(0, 0, 10)).isApprox(Eigen::Vector3d(10, 0.06, 0)));
  EXPECT_TRUE(
      (first * Eigen::Vector3d(0, 1, 0)).isApprox(Eigen::Vector3d(0, 0.06, -1)));

  const Eigen::Isometry3d second = poses.pose(frameOf(1, 0.0));
  // A point ahead of the turned camera lies to the left in the world: +y.
  EXPECT_TRUE(
      (second.linear() * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitY()));
  EXPECT_TRUE(second.translation().isApprox(Eigen::Vector3d(4.94, 0.0, 0.0)));
}

TEST(TrajectoryPoses, FramesWithoutPoseAreNamed)
{
  TrajectoryPoses poses(
      StoredPoses(storedTrajectory(Trajectory(3, Eigen::Isometry3d::Identity()))));
  EXPECT_EQ(thrownMessage<BadInputException>([&] { poses.pose(frameOf(3, 0.0)); }),
            "poses.txt: has 3 poses, none for frame 3 (row = frame number)");
  poses.requirePoses({{0, 0.0}, {2, 0.2}});
  poses.requirePoses({});
  EXPECT_EQ(thrownMessage<BadInputException>([&] {
              poses.requirePoses({{1, 0.1}, {2, 0.2}, {5, 0.5}, {6, 0.6}});
            }),
            "poses.txt: has 3 poses, none for frame 5 (row = frame number); 2 of 4 "
            "frames lack one");
}

TEST(PosesByTime, AreThoseOfTheSameTrajectoryByRow)
{
  Trajectory rows(3, Eigen::Isometry3d::Identity());
  TimedTrajectory timed;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].translation() << 0.1 * double(i), 0.2, double(i);
    timed.push_back({0.1 * double(i) + 4e-6, rows[i]});
  }
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity();
  T_camera0_camera.translation().x() = -0.06;
  TrajectoryPoses by_time(StoredPoses(storedTrajectory(timed), T_camera0_camera));
  TrajectoryPoses by_row(StoredPoses(storedTrajectory(rows), T_camera0_camera));
  for (int i = 0; i < 3; ++i) {
    const StereoFrame frame = frameOf(i, 0.1 * i);
    EXPECT_EQ(by_time.pose(frame).matrix(), by_row.pose(frame).matrix());
  }
}

TEST(PosesByTime, AFrameWithoutPoseIsNamed)
{
  TrajectoryPoses poses(StoredPoses(
      storedTrajectory(TimedTrajectory{{1.0, Eigen::Isometry3d::Identity()}})));
  EXPECT_EQ(thrownMessage<BadInputException>([&] { poses.pose(frameOf(7, 1.02)); }),
            "tum.txt: has no pose within 0.01 s of 1.02 s, the time of frame 7, nor "
            "two around it within 0.2 s; its times are from 1 to 1 s");
}

TEST(PosesByTime, AreAllRequiredBeforeTheFirstFrame)
{
  const double start = 1403636579.763555584; // as ORB-SLAM writes EuRoC's
  TimedTrajectory trajectory(4);
  for (const int i : {0, 1, 2, 3})
    trajectory[std::size_t(i)].time = start + (i < 2 ? 0.05 * i : 0.05 * (i + 4));
  const TrajectoryPoses poses(StoredPoses(storedTrajectory(trajectory)));
  std::vector<FrameTime> frames;
  for (const int i : {0, 1, 6, 7})
    frames.push_back({10 + i, start + 0.05 * i});
  poses.requirePoses(frames);
  poses.requirePoses({});
  frames.push_back({12, start + 0.1}); // lost in the middle
  frames.push_back({18, start + 0.4});
  EXPECT_EQ(
      thrownMessage<BadInputException>([&] { poses.requirePoses(frames); }),
      "tum.txt: has no pose within 0.01 s of 1403636579.86356 s, the time of frame 12, "
      "nor two around it within 0.2 s; its times are from 1403636579.76356 to "
      "1403636580.11356 s; 2 of 6 frames lack one");
}

TEST(PosesByTime, AreInterpolatedInSmallGaps)
{
  TimedTrajectory trajectory(4);
  for (std::size_t i = 0; i < 4; ++i) {
    trajectory[i].time = i < 3 ? 0.1 * double(i) : 1.0;
    trajectory[i].pose.translation().x() = double(i);
    trajectory[i].pose.rotate(
        Eigen::AngleAxisd(0.1 * double(i), Eigen::Vector3d::UnitY()));
  }
  StoredTrajectory stored = storedTrajectory(trajectory);
  stored.frame = PoseFrame::sensor;
  const StoredPoses poses(stored);
  for (const double time : {0.0, 0.03, 0.05, 0.1, 0.17, 0.2}) {
    const Eigen::Isometry3d pose = poses.pose({0, time});
    EXPECT_NEAR(pose.translation().x(), 10.0 * time, 1e-9);
    const Eigen::AngleAxisd turn(pose.linear());
    EXPECT_NEAR(turn.angle(), time, 1e-4); // the arc itself
  }
  EXPECT_EQ(poses.pose({0, 0.209}).translation().x(), 2.0); // the nearest one
  StoredTrajectory coarse = stored;
  for (std::size_t i = 0; i < 4; ++i)
    coarse.poses[i].time = 1.4e9 + 0.2 * double(i); // gaps of 0.2 s, rounded
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(StoredPoses(coarse).pose({0, 1.4e9 + 0.2 * i + 0.1}).translation().x(),
                i + 0.5, 1e-5);
  EXPECT_THROW(poses.pose({0, 0.5}), BadInputException);
  EXPECT_THROW(poses.pose({0, 1.1}), BadInputException);
  const StoredPoses wide(stored, Eigen::Isometry3d::Identity(), 1.0);
  EXPECT_NEAR(wide.pose({0, 0.6}).translation().x(), 2.5, 1e-9);
  const StoredPoses none(stored, Eigen::Isometry3d::Identity(), 0.0);
  EXPECT_EQ(none.pose({0, 0.108}).translation().x(), 1.0);
  EXPECT_THROW(none.pose({0, 0.05}), BadInputException);
  EXPECT_THROW(StoredPoses(stored, Eigen::Isometry3d::Identity(), -1.0),
               InvalidParameterException);
}

TEST(PoseFile, ReadsEitherFormat)
{
  const TemporaryFolder folder;
  const std::string kitti =
      folder.write("kitti.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 2\n");
  const std::string tum =
      folder.write("tum.txt", "# made by hand\n5 0 0 0 0 0 0 1\n6 0 0 2 0 0 0 1\n");
  // 0.1 m right of camera 0, which drove 2 m forward: world x forward, y left.
  const Eigen::Isometry3d T_camera0_camera(Eigen::Translation3d(0.1, 0.0, 0.0));
  for (const std::string& path : {kitti, tum}) {
    const auto poses = readPoses(path, T_camera0_camera);
    const Eigen::Isometry3d pose = poses->pose(frameOf(1, 6.0));
    EXPECT_TRUE(pose.translation().isApprox(Eigen::Vector3d(2.0, -0.1, 0.0))) << path;
    EXPECT_TRUE(
        readPoses(path)->pose(frameOf(0, 5.0)).isApprox(worldFromFirstCamera()));
    const std::string message = thrownMessage<BadInputException>([&] {
      poses->requirePoses({{0, 5.0}, {7, 12.0}});
    });
    EXPECT_NE(message.find(path), std::string::npos) << message;
  }
}

TEST(PoseFile, RefusesWhatIsNeither)
{
  const TemporaryFolder folder;
  EXPECT_THROW(readPoses(folder.path("nowhere.txt")), BadInputException);
  EXPECT_THROW(readPoses(folder.write("nine.txt", "1 2 3 4 5 6 7 8 9\n")),
               BadInputException);
}

} // namespace
