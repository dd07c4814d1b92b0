// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <gtest/gtest.h>

#include <random>

using namespace pcl_semantic;

namespace {

TimedTrajectory
readText(const std::string& text)
{
  const TemporaryFolder folder;
  return readTumTrajectory(folder.write("tum.txt", text));
}

std::string
refusal(const std::string& text)
{
  return thrownMessage<BadInputException>([&] { readText(text); });
}

TimedTrajectory
randomTrajectory(double start)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  TimedTrajectory trajectory;
  for (int i = 0; i < 100; ++i) {
    TimedPose timed;
    timed.time = start + 0.1 * i;
    timed.pose.linear() =
        Eigen::Quaterniond(value(random), value(random), value(random), value(random))
            .normalized()
            .toRotationMatrix();
    timed.pose.translation() << 1e4 * value(random), value(random),
        1e-6 * value(random);
    trajectory.push_back(timed);
  }
  return trajectory;
}

} // namespace

TEST(TumTrajectory, ReadsTimeTranslationAndQuaternion)
{
  // A quarter turn about z: x goes to y.
  const TimedTrajectory trajectory = readText(
      "# time tx ty tz qx qy qz qw\n\n1.5 4 5 -6.5 0 0 0.70710678 0.70710678\r\n");
  ASSERT_EQ(trajectory.size(), 1u);
  EXPECT_EQ(trajectory[0].time, 1.5);
  EXPECT_EQ(trajectory[0].pose.translation(), Eigen::Vector3d(4.0, 5.0, -6.5));
  EXPECT_TRUE((trajectory[0].pose.linear() * Eigen::Vector3d::UnitX())
                  .isApprox(Eigen::Vector3d::UnitY(), 1e-7));
}

// The forms of ORB-SLAM2 and ORB-SLAM3: fixed, 6 to 9 digits, seconds or nanoseconds.
TEST(TumTrajectory, ReadsWhatOrbSlamWrites)
{
  const TimedTrajectory two =
      readText("1403636579.763556 0.0000000 0.0000000 0.0000000 0.0000000 0.0000000 "
               "0.0000000 1.0000000\n"
               "1403636580.263556 0.1000000 0.0000000 0.0000000 0.0000000 0.0000000 "
               "0.0000000 1.0000000\n");
  EXPECT_NEAR(two[1].time - two[0].time, 0.5, 1e-6);
  const TimedTrajectory three =
      readText("1403636579763555584.000000 0.1 0.2 0.3 0 0 0 1.000000000\n"
               "1403636580263555584.000000 0.1 0.2 0.3 0 0 0 -1.000000000\n");
  EXPECT_NEAR(three[0].time, 1403636579.763555584, 1e-6);
  EXPECT_NEAR(three[1].time - three[0].time, 0.5, 1e-6);
  EXPECT_TRUE(three[1].pose.linear().isIdentity());
}

TEST(TumTrajectory, RoundTrips)
{
  for (const double start : {0.0, 1403636579.763555584}) {
    const TimedTrajectory written = randomTrajectory(start);
    const TemporaryFolder folder;
    writeTumTrajectory(folder.path("tum.txt"), written);
    const TimedTrajectory read = readTumTrajectory(folder.path("tum.txt"));
    ASSERT_EQ(read.size(), written.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
      EXPECT_NEAR(read[i].time, written[i].time, 1e-6);
      EXPECT_EQ(read[i].pose.translation(), written[i].pose.translation());
      EXPECT_TRUE(read[i].pose.linear().isApprox(written[i].pose.linear(), 1e-14));
    }
  }
}

TEST(TumTrajectory, NamesTheLineOfWhatCannotBeUsed)
{
  const std::string good = "1 0 0 0 0 0 0 1\n";
  EXPECT_TRUE(holds(refusal("# x\n" + good + "2 0 0 0 0 0 0\n"), "line 3: has 7"));
  EXPECT_TRUE(holds(refusal(good + "2 0 0 nan 0 0 0 1\n"), "line 2: 'nan'"));
  EXPECT_TRUE(holds(refusal(good + "2 0 0 1,5 0 0 0 1\n"), "line 2: '1,5'"));
  EXPECT_TRUE(holds(refusal(good + "2 0 0 0 0 0 0 1.1\n"), "line 2: the quaternion"));
  EXPECT_TRUE(holds(refusal(good + "2 0 0 0 0 0 0 0\n"), "line 2: the quaternion"));
  EXPECT_TRUE(holds(refusal(good + good), "line 2: its time"));
  EXPECT_TRUE(holds(refusal("# nothing\n"), "holds no pose"));
}

TEST(TumTrajectory, MakesAQuaternionOfNearlyLengthOneExact)
{
  testing::internal::CaptureStderr();
  const TimedTrajectory trajectory =
      readText("1 0 0 0 0 0 0 1\n2 0 0 0 0 0.6 0 0.803\n");
  EXPECT_TRUE(
      holds(testing::internal::GetCapturedStderr(),
            "tum.txt: warning: 1 of 2 poses were not quite rigid and made so, the "
            "first in line 2\n"));
  const Eigen::Matrix3d rotation = trajectory[1].pose.linear();
  EXPECT_TRUE((rotation * rotation.transpose()).isIdentity(1e-14));
}

TEST(KittiTrajectory, WarnsOfRotationsItHadToRepair)
{
  const TemporaryFolder folder;
  const std::string good = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  testing::internal::CaptureStderr();
  readKittiTrajectory(
      folder.write("good.txt", good + "0.9999996 0 0 0 0 1 0 0 0 0 1 0\n"));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  testing::internal::CaptureStderr();
  readKittiTrajectory(folder.write("bad.txt", good + "0.999 0 0 0 0 1 0 0 0 0 1 0\n"));
  EXPECT_TRUE(holds(testing::internal::GetCapturedStderr(), "the first in line 2"));
}

TEST(KittiTrajectory, HasARowForEveryFrame)
{
  const TemporaryFolder folder;
  const std::string row = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  const auto read = [&](const std::string& text) {
    return readKittiTrajectory(folder.write("poses.txt", text));
  };
  EXPECT_EQ(read("# by some tool\n#\n" + row + row + "\n\n").size(), 2u);
  for (const char* const gap : {"\n", "# lost\n", " \r\n"})
    EXPECT_TRUE(holds(thrownMessage<BadInputException>([&] { read(row + gap + row); }),
                      "poses.txt line 2: holds no pose, but a later line does"));
  EXPECT_TRUE(holds(thrownMessage<BadInputException>([&] { read("# nothing\n"); }),
                    "poses.txt: holds no pose"));
}

TEST(KittiTrajectory, ShowsNoBytesOfABinaryFile)
{
  const TemporaryFolder folder;
  const std::string path = folder.write("poses.txt", std::string("\x1b[2J\x01x", 6));
  EXPECT_EQ(thrownMessage<BadInputException>([&] { readKittiTrajectory(path); }),
            path + " line 1: '?[2J?x' is not a number");
}

TEST(TrajectoryFormat, IsKnownByTheNumbers)
{
  const TemporaryFolder folder;
  const auto format = [&](const std::string& text) {
    return trajectoryFormatOf(folder.write("some.txt", text));
  };
  EXPECT_EQ(format("1 0 0 0 0 1 0 0 0 0 1 0\n"), TrajectoryFormat::kitti);
  EXPECT_EQ(format("\n1 0 0 0 0 0 0 1\n"), TrajectoryFormat::tum);
  EXPECT_EQ(format("# time\n1 0 0 0 0 0 0 1\n"), TrajectoryFormat::tum);
  EXPECT_EQ(format("# poses\n1 0 0 0 0 1 0 0 0 0 1 0\n"), TrajectoryFormat::kitti);
  for (const char* const bad : {"", "\n", "# nothing\n", "1 2 3\n", "a b\n"})
    thrownMessage<BadInputException>([&] { format(bad); });
}

TEST(FindPose, GivesTheNearestWithinTheTolerance)
{
  TimedTrajectory trajectory(3);
  for (int i = 0; i < 3; ++i)
    trajectory[std::size_t(i)].time = i;
  EXPECT_EQ(findPose(trajectory, 1.4, 0.5), &trajectory[1]);
  EXPECT_EQ(findPose(trajectory, 1.6, 0.5), &trajectory[2]);
  EXPECT_EQ(findPose(trajectory, 2.5, 0.5), &trajectory[2]);
  EXPECT_EQ(findPose(trajectory, -0.5, 0.5), &trajectory[0]);
  EXPECT_EQ(findPose(trajectory, 1.4, 0.3), nullptr);
  EXPECT_EQ(findPose(trajectory, 9.0, 0.5), nullptr);
  EXPECT_EQ(findPose({}, 1.0, 0.5), nullptr);
}

TEST(Times, AreReadByRow)
{
  const TemporaryFolder folder;
  EXPECT_EQ(readTimes(folder.write("times.txt", "0\n1.5e-1\n\n")),
            (std::vector<double>{0.0, 0.15}));
  EXPECT_NEAR(readTimes(folder.write("times.txt", "1403636579763555584\n")).front(),
              1403636579.763555584, 1e-6);
  for (const char* const bad : {"0\n1 2\n", "0\n\n1\n", "0\nx\n", "0\nnan\n"})
    EXPECT_TRUE(holds(thrownMessage<BadInputException>(
                          [&] { readTimes(folder.write("times.txt", bad)); }),
                      "line 2"));
}
