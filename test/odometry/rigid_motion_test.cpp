// SPDX-License-Identifier: BSD-3-Clause
#include <odometry/stereo_projection.h>

#include <gtest/gtest.h>

#include <random>

namespace {

using namespace pcl_semantic::odometry;

Vector6d
randomVelocity(std::mt19937& random, double size)
{
  std::uniform_real_distribution<double> value(-size, size);
  Vector6d velocity;
  for (double& each : velocity)
    each = value(random);
  return velocity;
}

// Many small steps one after the other.
Eigen::Isometry3d
integrated(const Vector6d& velocity)
{
  constexpr int steps = 1 << 20;
  Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
  step.linear() += crossMatrix(velocity.tail<3>() / steps);
  step.translation() = velocity.head<3>() / steps;
  for (int doubled = 1; doubled < steps; doubled *= 2)
    step = Eigen::Isometry3d((step * step).matrix());
  return step;
}

} // namespace

TEST(RigidMotion, ExpIsWhatManySmallStepsMake)
{
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    const Vector6d velocity = randomVelocity(random, 1.0);
    EXPECT_TRUE(
        expMotion(velocity).matrix().isApprox(integrated(velocity).matrix(), 1e-5));
  }
}

TEST(RigidMotion, LogIsTheInverseOfExp)
{
  std::mt19937 random(2);
  for (const double size : {1e-9, 1e-4, 1e-2, 1.0, 1.7})
    for (int i = 0; i < 50; ++i) {
      const Vector6d velocity = randomVelocity(random, size);
      EXPECT_LT((logMotion(expMotion(velocity)) - velocity).norm(),
                1e-6 * size + 1e-12);
    }
  EXPECT_EQ(logMotion(Eigen::Isometry3d::Identity()).norm(), 0.0);
}

TEST(RigidMotion, AdjointCarriesASmallMotionToTheOtherSide)
{
  std::mt19937 random(3);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Isometry3d motion = expMotion(randomVelocity(random, 1.5));
    const Vector6d small = randomVelocity(random, 0.3);
    EXPECT_TRUE((motion * expMotion(small))
                    .isApprox(expMotion(adjoint(motion) * small) * motion, 1e-9));
  }
}
