// SPDX-License-Identifier: BSD-3-Clause
#include "support/stereo_points.h"

#include <odometry/pose_ransac.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::odometry;

Eigen::Isometry3d
someMotion()
{
  Vector6d motion;
  motion << 0.1, -0.03, -1.2, 0.01, 0.03, -0.005;
  return expMotion(motion);
}

// Every \a nth measurement is wrong.
std::vector<PoseMeasurement>
measure(const Eigen::Isometry3d& pose, int nth, std::mt19937& random)
{
  const StereoCamera camera = gridCamera();
  std::uniform_real_distribution<double> wrong(-40.0, 40.0);
  std::vector<PoseMeasurement> measurements;
  for (const Eigen::Vector3d& point : randomPoints(camera, 200, random)) {
    PoseMeasurement one;
    one.position = {point / point.z(), 1.0 / point.z()};
    one.uvd = seenAt(camera, pose * point) + randomError({}, random);
    if (measurements.size() % std::size_t(nth) == 0)
      one.uvd += Eigen::Vector3d(wrong(random), wrong(random), 5.0);
    measurements.push_back(one);
  }
  return measurements;
}

} // namespace

// The first sample may hold a wrong measurement while nothing agrees with the
// prediction.
TEST(PoseRansac, GoesOnUntilSomethingAgrees)
{
  std::mt19937 random(2);
  for (int round = 0; round < 100; ++round) {
    const std::vector<PoseMeasurement> measurements = measure(someMotion(), 2, random);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    estimatePose(gridCamera(), {}, measurements, pose);
    EXPECT_LT(logMotion(pose * someMotion().inverse()).norm(), 0.02) << round;
  }
}

TEST(PoseRansac, FindsThePoseAmongWrongMeasurements)
{
  std::mt19937 random(1);
  for (const int nth : {1000, 5, 2}) {
    const std::vector<PoseMeasurement> measurements =
        measure(someMotion(), nth, random);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    const std::vector<char> inliers =
        estimatePose(gridCamera(), {}, measurements, pose);
    EXPECT_LT(logMotion(pose * someMotion().inverse()).norm(), 0.02) << nth;
    for (std::size_t i = 0; i < inliers.size(); ++i)
      EXPECT_FALSE(i % std::size_t(nth) == 0 && inliers[i]) << i;
    EXPECT_GT(std::count(inliers.begin(), inliers.end(), 1),
              int(0.95 * (200 - 200 / nth)) - 1);
  }
}

TEST(PoseRansac, TooFewMeasurementsGiveNoInliers)
{
  std::mt19937 random(2);
  std::vector<PoseMeasurement> measurements = measure(someMotion(), 1000, random);
  measurements.resize(2);
  Eigen::Isometry3d pose = someMotion();
  const std::vector<char> inliers = estimatePose(gridCamera(), {}, measurements, pose);
  EXPECT_EQ(inliers, std::vector<char>(2, 0));
  EXPECT_TRUE(pose.isApprox(someMotion()));
}

TEST(PoseRansac, IsTheSameEveryTime)
{
  std::mt19937 random(3);
  const std::vector<PoseMeasurement> measurements = measure(someMotion(), 3, random);
  Eigen::Isometry3d one = Eigen::Isometry3d::Identity(), two = one;
  estimatePose(gridCamera(), {}, measurements, one);
  estimatePose(gridCamera(), {}, measurements, two);
  EXPECT_EQ(one.matrix(), two.matrix());
}
