// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_distributions.h>

#include <Eigen/Core>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace pcl_semantic {

/** \brief A coloured cloud around the sensor with one label distribution per point. */
struct LabelledScan {
  pcl::PointCloud<pcl::PointXYZRGB> cloud;
  LabelDistributions distributions;
};

/** \brief Random points within \a reach of the sensor along each axis, with random
 * colours and distributions; every tenth point is unlabelled. */
inline LabelledScan
makeRandomScan(std::size_t count, float reach, int classes, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> coordinate(-reach, reach), share(0.001f, 1.0f);
  LabelledScan scan;
  LabelDistributions::Matrix weights(classes, Eigen::Index(count));
  for (std::size_t i = 0; i < count; ++i) {
    pcl::PointXYZRGB point;
    point.getVector3fMap() << coordinate(random), coordinate(random),
        coordinate(random);
    point.rgba = 0xFF000000u | (random() & 0xFFFFFFu);
    scan.cloud.push_back(point);
    for (int k = 0; k < classes; ++k)
      weights(k, Eigen::Index(i)) = i % 10 == 9 ? 0.0f : share(random);
  }
  scan.distributions = LabelDistributions(weights);
  return scan;
}

/** \brief The same scan in another order of its points. */
inline LabelledScan
shuffled(const LabelledScan& scan, unsigned seed)
{
  std::vector<int> order(scan.cloud.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    order[i] = int(i);
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  LabelledScan result;
  result.distributions =
      LabelDistributions(scan.distributions.classes(), scan.distributions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    result.cloud.push_back(scan.cloud[order[i]]);
    result.distributions.matrix().col(Eigen::Index(i)) =
        scan.distributions.matrix().col(order[i]);
  }
  return result;
}

/** \brief Points seen by a camera that looks along z: a regular grid of slopes from
 * -0.6 to 0.6 in steps of \a step, a wavy surface with noise, poles in front of it, and
 * holes. \a depth is the maximum; some points are near. */
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
      if (std::sin(31.0 * u) * std::sin(23.0 * v) < 0.9) // otherwise a hole
        points.emplace_back(float(u * z), float(v * z), float(z));
    }
  return points;
}

} // namespace pcl_semantic
