// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <odometry/stereo_projection.h>

#include <random>
#include <vector>

namespace pcl_semantic {

/** \brief Approximately KITTI's grey cameras. */
inline StereoCamera
gridCamera()
{
  return {700.0, 700.0, 600.0, 180.0, 0.54, 1200, 360};
}

/** \brief Points in front of a camera, at a depth of 5 to 80 m. */
inline std::vector<Eigen::Vector3d>
randomPoints(const StereoCamera& camera, int count, std::mt19937& random)
{
  std::uniform_real_distribution<double> u(50.0, 1150.0), v(20.0, 340.0), z(5.0, 80.0);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const double column = u(random), row = v(random);
    points.push_back(camera.unproject(column, row, z(random)));
  }
  return points;
}

/** \brief Column, row and disparity from the pinhole equations, independent of
 * projectStereo(). */
inline Eigen::Vector3d
seenAt(const StereoCamera& camera, const Eigen::Vector3d& point)
{
  const Eigen::Vector2d left = camera.project(point);
  const Eigen::Vector2d right =
      camera.project(point - Eigen::Vector3d(camera.baseline, 0.0, 0.0));
  return {left.x(), left.y(), left.x() - right.x()};
}

inline Eigen::Vector3d
randomError(const odometry::MeasurementNoise& noise, std::mt19937& random)
{
  std::normal_distribution<double> normal;
  const double u = normal(random), v = normal(random), d = normal(random);
  return {noise.pixel * u, noise.pixel * v, noise.disparity * d};
}

} // namespace pcl_semantic
