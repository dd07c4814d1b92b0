// SPDX-License-Identifier: BSD-3-Clause
#include "support/refused_file.h"

#include <pcl_semantic/files/trajectory_file.h>

#include <gtest/gtest.h>

#include <random>
#include <sstream>

using namespace pcl_semantic;

namespace {

const std::string identity = "1 0 0 0 0 1 0 0 0 0 1 0";

Trajectory
readKitti(const std::string& text)
{
  const TemporaryFolder folder;
  return readKittiTrajectory(folder.write("poses.txt", text));
}

TimedTrajectory
readTum(const std::string& text)
{
  const TemporaryFolder folder;
  return readTumTrajectory(folder.write("tum.txt", text));
}

::testing::AssertionResult
refusesKitti(const std::string& text, const std::string& part)
{
  return refusesFile("poses.txt", text, part,
                     [](const std::string& path) { return readKittiTrajectory(path); });
}

::testing::AssertionResult
refusesTum(const std::string& text, const std::string& part)
{
  return refusesFile("tum.txt", text, part,
                     [](const std::string& path) { return readTumTrajectory(path); });
}

Eigen::Matrix3d
someRotation()
{
  return Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized())
      .toRotationMatrix();
}

// A row whose rotation was multiplied by `stretch` in its first column.
std::string
stretchedRow(double stretch)
{
  Eigen::Matrix3d rotation = someRotation();
  rotation.col(0) *= stretch;
  std::ostringstream row;
  row.precision(17);
  for (int i = 0; i < 3; ++i)
    row << rotation(i, 0) << ' ' << rotation(i, 1) << ' ' << rotation(i, 2) << " 7 ";
  return row.str();
}

// Far, near and tiny coordinates, any rotations, 10 a second.
TimedTrajectory
randomTrajectory(double start)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  TimedTrajectory trajectory(200);
  for (TimedPose& timed : trajectory) {
    timed.time = start + 0.1 * double(&timed - trajectory.data());
    timed.pose.linear() =
        Eigen::Quaterniond(value(random), value(random), value(random), value(random))
            .normalized()
            .toRotationMatrix();
    timed.pose.translation() << 1e5 * value(random), value(random),
        1e-7 * value(random);
  }
  return trajectory;
}

} // namespace

TEST(KittiTrajectory, ReadsRowsOfTwelveNumbersFromEveryEditor)
{
  const Trajectory poses = readKitti("\xEF\xBB\xBF" + identity +
                                     "  \r\n0 -1 0 4 1 0 0 5e0 0 0 1 -6.5\t\r\n\r\n");
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_TRUE(poses[0].isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_EQ(poses[1].translation(), Eigen::Vector3d(4.0, 5.0, -6.5));
  EXPECT_EQ(poses[1].linear() * Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
}

TEST(KittiTrajectory, RoundTripsExactly)
{
  Trajectory written;
  for (const TimedPose& timed : randomTrajectory(0.0))
    written.push_back(timed.pose);
  const TemporaryFolder folder;
  writeKittiTrajectory(folder.path("poses.txt"), written);
  const Trajectory read = readKittiTrajectory(folder.path("poses.txt"));
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i)
    EXPECT_EQ(read[i].matrix(), written[i].matrix());
}

TEST(KittiTrajectory, NamesTheLineOfWhatCannotBeUsed)
{
  const std::string good = identity + "\n";
  EXPECT_TRUE(refusesKitti(good + identity.substr(0, 21),
                           "line 2: has 11 numbers, expected 12"));
  EXPECT_TRUE(refusesKitti(good + identity + " 0\n", "line 2: has 13 numbers"));
  for (const char* const bad : {"nan", "inf", "-inf", "1,5", "abc", "1e999"})
    EXPECT_TRUE(refusesKitti(good + "1 0 0 0 0 1 0 0 0 0 1 " + bad, "line 2")) << bad;
  EXPECT_TRUE(refusesKitti("1 0 0 0 0 1 0 0 0 0 -1 0", "line 1")); // a mirror
  for (const char* const none : {"0 0 0 0 0 0 0 0 0 0 0 0", "1.1 0 0 0 0 1 0 0 0 0 1 0",
                                 "-1 0 0 0 0 -1 0 0 0 0 -1 0"})
    EXPECT_TRUE(refusesKitti(none, "line 1: the left 3 x 3 block")) << none;
  EXPECT_TRUE(refusesKitti(stretchedRow(1.1), "rotation"));
  // The bytes of a binary file are not shown.
  EXPECT_TRUE(refusesKitti(std::string("\x1b[2J\x01x", 6),
                           "poses.txt line 1: '?[2J?x' is not a number"));
  // It has a row for every frame.
  EXPECT_EQ(readKitti("# by some tool\n#\n" + good + good + "\n \n").size(), 2u);
  for (const char* const gap : {"\n", "# lost\n", " \r\n"})
    EXPECT_TRUE(refusesKitti(
        good + gap + good, "poses.txt line 2: is empty, but a later line has a pose"));
  for (const char* const nothing : {"", "\n\n", "# nothing\n"})
    EXPECT_TRUE(refusesKitti(nothing, "poses.txt: holds no pose"));
  thrownMessage<BadInputException>([] { readKittiTrajectory("/no/such/poses.txt"); });
}

TEST(KittiTrajectory, MakesARotationThatIsNearlyOneOrthonormal)
{
  const Trajectory poses = readKitti(stretchedRow(1.001));
  const Eigen::Matrix3d rotation = poses.at(0).linear();
  EXPECT_LT((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm(),
            1e-12);
  EXPECT_GT(rotation.determinant(), 0.0);
  EXPECT_LT((rotation - someRotation()).norm(), 2e-3);
  EXPECT_EQ(poses[0].translation(), Eigen::Vector3d::Constant(7.0));
  for (const auto& [scale, warning] :
       {std::pair("0.9999996", ""), std::pair("0.999", "the first in line 2")}) {
    const TemporaryFolder folder;
    std::vector<std::string> doubts;
    readKittiTrajectory(
        folder.write("poses.txt", identity + "\n" + scale + " 0 0 0 0 1 0 0 0 0 1 0\n"),
        &doubts);
    EXPECT_EQ(doubts.empty(), warning[0] == '\0');
    if (!doubts.empty()) {
      EXPECT_TRUE(holds(doubts[0], warning));
    }
  }
}

TEST(TumTrajectory, ReadsTimeTranslationAndQuaternion)
{
  // A quarter turn about z: x goes to y.
  const TimedTrajectory trajectory = readTum(
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
      readTum("1403636579.763556 0.0000000 0.0000000 0.0000000 0.0000000 0.0000000 "
              "0.0000000 1.0000000\n"
              "1403636580.263556 0.1000000 0.0000000 0.0000000 0.0000000 0.0000000 "
              "0.0000000 1.0000000\n");
  EXPECT_NEAR(two[1].time - two[0].time, 0.5, 1e-6);
  const TimedTrajectory three =
      readTum("1403636579763555584.000000 0.1 0.2 0.3 0 0 0 1.000000000\n"
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
  for (const auto& [text, part] :
       {std::pair("2 0 0 0 0 0 0\n", "line 2: has 7"),
        std::pair("# x\n2 0 0 nan 0 0 0 1\n", "line 3: 'nan'"),
        std::pair("2 0 0 1,5 0 0 0 1\n", "line 2: '1,5'"),
        std::pair("2 0 0 0 0 0 0 1.1\n", "line 2: the quaternion"),
        std::pair("2 0 0 0 0 0 0 0\n", "line 2: the quaternion has length 0"),
        std::pair("1 0 0 0 0 0 0 1\n", "line 2: time is not later than"),
        std::pair("0 0 0 0 0 0 0 1\n", "line 2: time is not later than")})
    EXPECT_TRUE(refusesTum(good + text, part));
  EXPECT_TRUE(refusesTum("# nothing\n", "holds no pose"));
}

TEST(TumTrajectory, MakesAQuaternionOfNearlyLengthOneExact)
{
  const TemporaryFolder folder;
  std::vector<std::string> doubts;
  const TimedTrajectory trajectory = readTumTrajectory(
      folder.write("tum.txt", "1 0 0 0 0 0 0 1\n2 0 0 0 0 0.6 0 0.803\n"), &doubts);
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_TRUE(holds(doubts[0], "tum.txt: 1 of 2 poses were not exactly rigid and were "
                               "corrected, the first in line 2"));
  const Eigen::Matrix3d rotation = trajectory[1].pose.linear();
  EXPECT_TRUE((rotation * rotation.transpose()).isIdentity(1e-14));
}

TEST(TrajectoryFormat, IsKnownByTheNumbers)
{
  const TemporaryFolder folder;
  const auto format = [&](const std::string& text) {
    return trajectoryFormatOf(folder.write("some.txt", text));
  };
  for (const char* const before : {"", "\n", "# time\n"}) {
    EXPECT_EQ(format(before + identity), TrajectoryFormat::kitti);
    EXPECT_EQ(format(std::string(before) + "1 0 0 0 0 0 0 1"), TrajectoryFormat::tum);
  }
  for (const char* const near :
       {"1 0 0 0 0 1 0 0 0 0 1\n", "0 1 0 0 0 0 1 0 0 0 0 1 0\n"})
    EXPECT_EQ(format(near), TrajectoryFormat::kitti) << "whose reader names the line";
  for (const char* const bad :
       {"", "\n", "# nothing\n", "1 2 3\n", "a b\n", "1 0 0 0 0 1 0 0 0 0\n",
        "0 1 0 0 0 0 1 0 0 0 0 1 0 0\n"})
    thrownMessage<BadInputException>([&] { format(bad); });
  const auto said = [&](const std::string& text) {
    return thrownMessage<BadInputException>([&] { format(text); });
  };
  EXPECT_TRUE(
      holds(said("#time, x\n1403636579763555584,4.6,-1.8,0.8,0.5,-0.1,-0.8,-0.1\n"),
            "line 2: has commas, expected lines of 12 numbers (KITTI) or 8"));
  EXPECT_TRUE(holds(said("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n"),
                    "line 1: begins with 'VERTEX_SE3:QUAT"));
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
  const auto read = [&](const std::string& text) {
    return readTimes(folder.write("times.txt", text));
  };
  EXPECT_EQ(read("0\n1.5e-1\n\n"), (std::vector<double>{0.0, 0.15}));
  EXPECT_NEAR(read("1403636579763555584\n").front(), 1403636579.763555584, 1e-6);
  for (const char* const bad : {"0\n1 2\n", "0\n\n1\n", "0\nx\n", "0\nnan\n"})
    expectBadInput("line 2", [&] { read(bad); });
}
