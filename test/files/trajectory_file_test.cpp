// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <gtest/gtest.h>

#include <locale>
#include <random>
#include <sstream>

using namespace pcl_semantic;

namespace {

const std::string identity = "1 0 0 0 0 1 0 0 0 0 1 0";

Trajectory
readText(const std::string& text)
{
  const TemporaryFolder folder;
  return readKittiTrajectory(folder.write("poses.txt", text));
}

std::string
refusal(const std::string& text)
{
  return thrownMessage<BadInputException>([&] { readText(text); });
}

// A pose row whose rotation was multiplied by `stretch` in its first column.
std::string
rowOf(const Eigen::Matrix3d& rotation)
{
  std::ostringstream row;
  row.precision(17);
  for (int i = 0; i < 3; ++i)
    row << rotation(i, 0) << ' ' << rotation(i, 1) << ' ' << rotation(i, 2) << " 7 ";
  return row.str();
}

Eigen::Matrix3d
someRotation()
{
  return Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized())
      .toRotationMatrix();
}

} // namespace

TEST(KittiTrajectory, ReadsRowsOfTwelveNumbers)
{
  const Trajectory poses = readText(identity + "\n0 -1 0 4 1 0 0 5e0 0 0 1 -6.5\n");
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_TRUE(poses[0].isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_EQ(poses[1].translation(), Eigen::Vector3d(4.0, 5.0, -6.5));
  EXPECT_EQ(poses[1].linear() * Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
}

TEST(KittiTrajectory, AcceptsEveryEditor)
{
  EXPECT_EQ(
      readText("\xEF\xBB\xBF" + identity + "  \r\n" + identity + "\t\r\n\r\n").size(),
      2u);
}

TEST(KittiTrajectory, RoundTripsExactly)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  Trajectory written;
  for (int i = 0; i < 200; ++i) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() =
        Eigen::Quaterniond(value(random), value(random), value(random), value(random))
            .normalized()
            .toRotationMatrix();
    pose.translation() << 1e5 * value(random), value(random), 1e-7 * value(random);
    written.push_back(pose);
  }
  const TemporaryFolder folder;
  writeKittiTrajectory(folder.path("poses.txt"), written);
  const Trajectory read = readKittiTrajectory(folder.path("poses.txt"));
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i)
    EXPECT_EQ(read[i].matrix(), written[i].matrix());
}

TEST(KittiTrajectory, NamesTheLineOfAWrongCount)
{
  EXPECT_TRUE(
      holds(refusal(identity + "\n" + identity.substr(0, 21) + "\n"), "line 2"));
  EXPECT_TRUE(holds(refusal(identity + "\n" + identity + " 0\n"), "line 2"));
  EXPECT_TRUE(holds(refusal(identity + "\n" + identity.substr(0, 21) + "\n"), "11"));
}

TEST(KittiTrajectory, RefusesWhatIsNoFiniteNumber)
{
  for (const char* const bad : {"nan", "inf", "-inf", "1,5", "abc", "1e999"})
    EXPECT_TRUE(holds(refusal(identity + "\n1 0 0 0 0 1 0 0 0 0 1 " + bad), "line 2"))
        << bad;
}

TEST(KittiTrajectory, RefusesWhatIsNoRotation)
{
  EXPECT_TRUE(holds(refusal("1 0 0 0 0 1 0 0 0 0 -1 0"), "line 1")); // a mirror
  EXPECT_TRUE(holds(refusal("0 0 0 0 0 0 0 0 0 0 0 0"), "line 1"));
  Eigen::Matrix3d stretched = someRotation();
  stretched.col(0) *= 1.1;
  EXPECT_TRUE(holds(refusal(rowOf(stretched)), "rotation"));
}

TEST(KittiTrajectory, MakesARotationThatIsNearlyOneOrthonormal)
{
  Eigen::Matrix3d stretched = someRotation();
  stretched.col(0) *= 1.001;
  const Trajectory poses = readText(rowOf(stretched));
  const Eigen::Matrix3d rotation = poses.at(0).linear();
  EXPECT_LT((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm(),
            1e-12);
  EXPECT_GT(rotation.determinant(), 0.0);
  EXPECT_LT((rotation - someRotation()).norm(), 2e-3);
  EXPECT_EQ(poses[0].translation(), Eigen::Vector3d::Constant(7.0));
}

TEST(KittiTrajectory, RefusesAnEmptyLineBetweenPoses)
{
  EXPECT_TRUE(holds(refusal(identity + "\n\n" + identity + "\n"), "line 2"));
  EXPECT_EQ(readText(identity + "\n" + identity + "\n\n \n").size(), 2u);
}

TEST(KittiTrajectory, RefusesAnEmptyFile)
{
  refusal("");
  refusal("\n\n");
  thrownMessage<BadInputException>([] { readKittiTrajectory("/no/such/poses.txt"); });
}
