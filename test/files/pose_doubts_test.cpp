// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/files/pose_doubts.h>
#include <pcl_semantic/odometry/pose_source.h>
#include <pcl_semantic/odometry/trajectory_poses.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

namespace pcl_semantic {

namespace {

using Axis = Eigen::Vector3d;

// A way that winds over a plane, of a body with x forward, y left, z up that also nods
// and rolls, in a world with z up.
Trajectory
windingWay(double nod, double first_heading = 0.0)
{
  std::mt19937 random(1);
  std::normal_distribution<double> noise;
  Trajectory poses;
  Eigen::Vector3d position(3, 4, 5);
  double heading = first_heading;
  for (int i = 0; i < 100; ++i) {
    heading += 0.2 * noise(random);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = (Eigen::AngleAxisd(heading, Axis::UnitZ()) *
                     Eigen::AngleAxisd(nod + 0.1 * noise(random), Axis::UnitY()) *
                     Eigen::AngleAxisd(0.1 * noise(random), Axis::UnitX()))
                        .toRotationMatrix();
    position += Axis(std::cos(heading), std::sin(heading), 0.0);
    pose.translation() = position;
    poses.push_back(pose);
  }
  return poses;
}

// The same trajectory for a camera on the body, in the same world, or in the first
// camera's frame.
Trajectory
ofCamera(Trajectory poses, PoseFrame frame)
{
  const Eigen::Isometry3d T_body_camera = worldFromFirstCamera();
  for (Eigen::Isometry3d& pose : poses)
    pose = pose * T_body_camera;
  const Eigen::Isometry3d T_first_world = poses.front().inverse();
  if (frame == PoseFrame::first_camera)
    for (Eigen::Isometry3d& pose : poses)
      pose = T_first_world * pose;
  return poses;
}

// As a reader of x y z w takes a file of w x y z.
Trajectory
misread(Trajectory poses)
{
  for (Eigen::Isometry3d& pose : poses) {
    const Eigen::Quaterniond q(pose.linear());
    pose.linear() = Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
  }
  return poses;
}

const PoseFrame frames[] = {PoseFrame::first_camera, PoseFrame::camera,
                            PoseFrame::sensor};

Trajectory
wayOf(PoseFrame frame, double nod, double heading)
{
  const Trajectory body = windingWay(nod, heading);
  return frame == PoseFrame::sensor ? body : ofCamera(body, frame);
}

} // namespace

TEST(PoseDoubts, NoneOfPosesThatAreUpright)
{
  for (const PoseFrame frame : frames)
    for (const double heading : {0.0, 1.0, 2.0, 3.0})
      for (const double nod : {0.0, 0.4}) {
        const Trajectory way = wayOf(frame, nod, heading);
        for (const bool has_quaternions : {true, false})
          EXPECT_TRUE(doubtsOf(way, frame, has_quaternions).empty())
              << int(frame) << " " << heading << " " << nod;
      }
}

TEST(PoseDoubts, QuaternionsWithWFirst)
{
  for (const PoseFrame frame : frames)
    for (const double nod : {0.0, 0.4}) {
      const auto doubts = doubtsOf(misread(wayOf(frame, nod, 0.5)), frame, true);
      ASSERT_EQ(doubts.size(), 1u) << int(frame);
      EXPECT_TRUE(holds(doubts[0], "have w first: expected x y z w"));
    }
  // As of a camera that stands still: KITTI's first pose alone.
  const Eigen::Isometry3d turned(Eigen::AngleAxisd(EIGEN_PI, Axis::UnitX()));
  EXPECT_TRUE(
      holds(doubtsOf({turned}, PoseFrame::first_camera, true).at(0), "w first"));
}

TEST(PoseDoubts, PosesOfAnotherWorld)
{
  Trajectory body = windingWay(0.0);
  Trajectory in_world = ofCamera(body, PoseFrame::camera),
             in_first = ofCamera(body, PoseFrame::first_camera);
  Trajectory upside_down = body, far = body;
  for (Eigen::Isometry3d& pose : upside_down)
    pose.rotate(Eigen::AngleAxisd(EIGEN_PI, Axis::UnitX()));
  for (Eigen::Isometry3d& pose : far)
    pose.translation() *= 1000.0;
  for (const auto& [poses, frame, says] :
       {std::tuple(&in_world, PoseFrame::first_camera,
                   "tilted by more than 60 degrees"),
        std::tuple(&in_first, PoseFrame::camera, "the camera looks up or down"),
        std::tuple(&in_first, PoseFrame::sensor, "the path climbs"),
        std::tuple(&upside_down, PoseFrame::sensor, "upside down"),
        std::tuple(&far, PoseFrame::sensor,
                   "half of the poses are more than 1000 m from the one before: are "
                   "they in metres?")}) {
    const auto doubts = doubtsOf(*poses, frame, false);
    ASSERT_FALSE(doubts.empty()) << says;
    std::string all;
    for (const std::string& doubt : doubts)
      all += doubt + "\n";
    EXPECT_TRUE(holds(all, says));
  }
}

TEST(PoseDoubts, NamesTheFile)
{
  const TemporaryFolder folder;
  TimedTrajectory way;
  double time = 0.0;
  for (const Eigen::Isometry3d& pose : misread(windingWay(0.0, 0.5)))
    way.push_back({time += 0.1, pose});
  writeTumTrajectory(folder.path("tum.txt"), way);
  const auto doubts = readTrajectory(folder.path("tum.txt"), PoseFrame::sensor).doubts;
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_TRUE(holds(doubts[0], "tum.txt: most poses are tilted"));
  std::vector<std::string> of_poses;
  readSensorPoses(folder.path("tum.txt"), PoseFrame::sensor, StoredPoses::default_gap,
                  &of_poses);
  EXPECT_EQ(of_poses, doubts);
}

TEST(PoseDoubts, NoneOfRealData)
{
  const char* const data = std::getenv("PCL_SEMANTIC_DATA");
  if (!data)
    GTEST_SKIP() << "PCL_SEMANTIC_DATA is not set";
  for (const char* const name : {"00", "01", "03", "05", "06", "07", "09", "15"}) {
    Trajectory way =
        readKittiTrajectory(std::string(data) + "/kitti/" + name + "/poses.txt");
    Trajectory scanner = way, camera = way;
    for (std::size_t i = 0; i < way.size(); ++i) {
      camera[i] = worldFromFirstCamera() * way[i];
      scanner[i] = camera[i] * worldFromFirstCamera().inverse();
    }
    for (const auto& [poses, frame] :
         {std::pair(&way, PoseFrame::first_camera),
          std::pair(&camera, PoseFrame::camera), std::pair(&scanner, PoseFrame::sensor),
          std::pair(&camera, PoseFrame::sensor)}) {
      EXPECT_TRUE(doubtsOf(*poses, frame, true).empty()) << name << int(frame);
      // A camera that looks along x all the time has the same numbers in both orders.
      if (name == std::string("15") && poses == &camera)
        continue;
      const auto doubts = doubtsOf(misread(*poses), frame, true);
      EXPECT_TRUE(!doubts.empty() && holds(doubts[0], "w first")) << name << int(frame);
    }
  }
  const Trajectory room = readKittiTrajectory(std::string(data) + "/kitchen/poses.txt");
  EXPECT_TRUE(doubtsOf(room, PoseFrame::camera, true).empty());
  EXPECT_FALSE(doubtsOf(misread(room), PoseFrame::camera, true).empty());
}

} // namespace pcl_semantic
