// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cmath>
#include <random>
#include <vector>

namespace pcl_semantic {

/** \brief Points as a camera that looks along z sees them: a regular grid of slopes
 * from -0.6 to 0.6 with \a step between them, a wavy surface with noise, poles in front
 * of it, and holes. \a depth is the largest, some points lie near. */
inline std::vector<Eigen::Vector3f>
makeDenseScan(double step, double depth, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const double phase = 10.0 * share(random);
  std::vector<Eigen::Vector3f> points;
  for (double v = -0.6; v <= 0.6; v += step)
    for (double u = -0.6; u <= 0.6; u += step) {
      double z = depth * (0.6 + 0.4 * std::sin(4.0 * u + 7.0 * v + phase));
      z *= 1.0 + 0.02 * share(random);
      if (std::abs(std::sin(9.0 * u + phase)) < 0.15)
        z *= 0.3; // a pole
      if (share(random) < 0.05)
        z *= share(random);
      if (std::sin(31.0 * u) * std::sin(23.0 * v) < 0.9) // else a hole
        points.emplace_back(float(u * z), float(v * z), float(z));
    }
  return points;
}

} // namespace pcl_semantic
