// SPDX-License-Identifier: BSD-3-Clause
#include "support/stereo_points.h"

#include <odometry/window_adjustment.h>

#include <gtest/gtest.h>

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::odometry;

// A drive: points seen by several frames, each anchored at one of the first two.
struct Drive {
  StereoCamera camera = gridCamera();
  MeasurementNoise noise;
  std::vector<Eigen::Isometry3d> T_camera_world;
  std::vector<Eigen::Vector3d> points; ///< world
};

Drive
makeDrive(int frames, std::mt19937& random)
{
  Drive drive;
  drive.points = randomPoints(drive.camera, 150, random);
  Vector6d step;
  step << 0.02, -0.01, -0.9, 0.002, 0.01, -0.001;
  for (int i = 0; i < frames; ++i)
    drive.T_camera_world.push_back(expMotion(double(i) * step));
  return drive;
}

// As measured with noise and an offset; poses and depths start at the truth, disturbed.
WindowAdjustment
measured(const Drive& drive, double noise, double offset, std::mt19937& random)
{
  MeasurementNoise scaled = drive.noise;
  scaled.pixel *= noise;
  scaled.disparity *= noise;
  std::normal_distribution<double> normal;
  WindowAdjustment adjustment;
  adjustment.camera = drive.camera;
  adjustment.noise = drive.noise;
  for (std::size_t f = 0; f < drive.T_camera_world.size(); ++f) {
    Vector6d error = Vector6d::Zero();
    for (double& each : error)
      each = f == 0 ? 0.0 : 0.01 * normal(random);
    adjustment.frames.push_back({expMotion(error) * drive.T_camera_world[f], f == 0});
  }
  const auto see = [&](const Eigen::Isometry3d& pose, const Eigen::Vector3d& point) {
    Eigen::Vector3d uvd = seenAt(drive.camera, pose * point);
    uvd.z() += offset;
    return uvd;
  };
  for (std::size_t i = 0; i < drive.points.size(); ++i) {
    WindowAdjustment::Point point;
    point.anchor = i % 3 == 0 ? 1 : 0;
    const Eigen::Vector3d first =
        see(drive.T_camera_world[std::size_t(point.anchor)], drive.points[i]);
    point.position.ray = drive.camera.unproject(first.x(), first.y(), 1.0);
    point.anchor_disparity = first.z() + randomError(scaled, random).z();
    point.position.inverse_depth =
        std::max(first.z(), 1.0) / (drive.camera.fx * drive.camera.baseline);
    adjustment.points.push_back(point);
    for (int f = 0; f < int(drive.T_camera_world.size()); ++f)
      if (f != point.anchor && (f + int(i)) % 4 != 0)
        adjustment.measurements.push_back(
            {int(i), f,
             see(drive.T_camera_world[std::size_t(f)], drive.points[i]) +
                 randomError(scaled, random)});
  }
  return adjustment;
}

double
poseError(const Drive& drive, const WindowAdjustment& adjustment)
{
  double worst = 0.0;
  for (std::size_t f = 0; f < adjustment.frames.size(); ++f)
    worst = std::max(worst, logMotion(adjustment.frames[f].T_camera_world *
                                      drive.T_camera_world[f].inverse())
                                .norm());
  return worst;
}

} // namespace

TEST(WindowAdjustment, FindsPosesAndDepthsOfExactMeasurements)
{
  std::mt19937 random(1);
  const Drive drive = makeDrive(5, random);
  WindowAdjustment adjustment = measured(drive, 0.0, 0.0, random);
  EXPECT_GT(poseError(drive, adjustment), 0.01);
  EXPECT_LT(adjustment.solve(30), 1e-6);
  EXPECT_LT(poseError(drive, adjustment), 1e-5);
  for (std::size_t i = 0; i < drive.points.size(); ++i) {
    const WindowAdjustment::Point& point = adjustment.points[i];
    const double depth =
        (drive.T_camera_world[std::size_t(point.anchor)] * drive.points[i]).z();
    EXPECT_NEAR(point.position.inverse_depth * depth, 1.0, 1e-4);
  }
}

TEST(WindowAdjustment, FindsTheOffsetOfTheDisparities)
{
  std::mt19937 random(2);
  const Drive drive = makeDrive(6, random);
  WindowAdjustment adjustment = measured(drive, 0.0, -0.2, random);
  adjustment.offset_deviation = 1.0;
  adjustment.solve(50);
  EXPECT_NEAR(adjustment.offset, -0.2, 0.002);
  EXPECT_LT(poseError(drive, adjustment), 1e-3);
  // Taken for none, it makes the way longer.
  WindowAdjustment stubborn = measured(drive, 0.0, -0.2, random);
  stubborn.solve(50);
  EXPECT_NEAR(stubborn.offset, 0.0, 1e-6);
  EXPECT_GT(poseError(drive, stubborn), 0.01);
}

TEST(WindowAdjustment, OutliersHardlyMoveIt)
{
  std::mt19937 random(3);
  const Drive drive = makeDrive(4, random);
  WindowAdjustment adjustment = measured(drive, 1.0, 0.0, random);
  for (std::size_t m = 0; m < adjustment.measurements.size(); m += 20)
    adjustment.measurements[m].uvd += Eigen::Vector3d(15.0, -9.0, 4.0);
  adjustment.solve(30);
  EXPECT_LT(poseError(drive, adjustment), 0.03);
}

// The errors of many trials, seen through the covariance, have to have length 6.
TEST(WindowAdjustment, ItsCovarianceIsThatOfItsErrors)
{
  std::mt19937 random(4);
  double sum = 0.0;
  constexpr int trials = 200;
  for (int trial = 0; trial < trials; ++trial) {
    const Drive drive = makeDrive(3, random);
    WindowAdjustment adjustment = measured(drive, 1.0, 0.0, random);
    adjustment.frames[1] = {drive.T_camera_world[1], true};
    adjustment.solve(20);
    const Vector6d error = logMotion(adjustment.frames[2].T_camera_world *
                                     drive.T_camera_world[2].inverse());
    sum += error.dot(adjustment.covariance(2).ldlt().solve(error));
  }
  // Huber's weights cost a little; the mean of 200 has a deviation of 0.25.
  EXPECT_GT(sum / trials, 5.0);
  EXPECT_LT(sum / trials, 7.5);
}

TEST(WindowAdjustment, APointBehindTheCameraDoesNoHarm)
{
  std::mt19937 random(5);
  const Drive drive = makeDrive(3, random);
  WindowAdjustment adjustment = measured(drive, 0.0, 0.0, random);
  adjustment.points[0].position.inverse_depth = 10.0; // a decimetre: passed long ago
  adjustment.solve(20);
  EXPECT_LT(poseError(drive, adjustment), 1e-3);
}
