// SPDX-License-Identifier: BSD-3-Clause
#include "support/kitti_errors.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace pcl_semantic;

// Metres a pose along z, turning about y by an angle a pose.
Trajectory
drive(int poses, double metres, double turn)
{
  Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
  step.linear() = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()).toRotationMatrix();
  step.translation().z() = metres;
  Trajectory trajectory(1, Eigen::Isometry3d::Identity());
  while (int(trajectory.size()) < poses)
    trajectory.push_back(trajectory.back() * step);
  return trajectory;
}

TEST(KittiErrors, OfAScaleAreTheScale)
{
  const SegmentErrors errors =
      kittiErrors(drive(51, 1.0, 0.0), drive(51, 1.02, 0.0), {9.5, 19.5, 100.0});
  EXPECT_EQ(errors.segments,
            72u); // 10 poses further, from 0 to 40, and 20 from 0 to 30
  EXPECT_NEAR(errors.translation, (41 * 0.02 * 10 / 9.5 + 31 * 0.02 * 20 / 19.5) / 72,
              1e-9);
  EXPECT_NEAR(errors.rotation, 0.0, 1e-9);
  EXPECT_TRUE(std::isnan(
      kittiErrors(drive(5, 1.0, 0.0), drive(5, 1.0, 0.0), {100.0}).translation));
}

TEST(KittiErrors, OfATurnAreTheAngleByTheWayFromAnyStart)
{
  Trajectory turned = drive(30, 1.0, 1e-4);
  Eigen::Isometry3d elsewhere(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitX()));
  elsewhere.translation() << 5, 6, 7;
  for (Eigen::Isometry3d& pose : turned)
    pose = elsewhere * pose;
  const SegmentErrors errors = kittiErrors(drive(30, 1.0, 0.0), turned, {9.5});
  EXPECT_NEAR(errors.rotation, 10 * 1e-4 / 9.5, 1e-9);
}

} // namespace
