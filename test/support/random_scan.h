// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_distributions.h>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <random>

namespace pcl_semantic {

/** \brief A coloured cloud around the sensor with a label distribution a point. */
struct LabelledScan {
  pcl::PointCloud<pcl::PointXYZRGB> cloud;
  LabelDistributions distributions;
};

/** \brief Random points within \a reach of the sensor in each axis, random colours and
 * distributions; every tenth point is unlabelled. */
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

/** \brief The same scan with its points in another order. */
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

} // namespace pcl_semantic
