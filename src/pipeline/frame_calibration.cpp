// SPDX-License-Identifier: BSD-3-Clause
#include "frame_calibration.h"
#include "core/fail.h"
#include "stereo/cloud_features.h"

namespace pcl_semantic {

std::vector<PointFeatures>
frameFeatures(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
              const LabelDistributions& distributions, const std::vector<Label>& ground)
{
  if (Eigen::Index(cloud.size()) != distributions.size())
    badParameter("frame features: ", distributions.size(), " distributions for ",
                 cloud.size(), " points");
  constexpr float sure = 0.5f;
  std::vector<std::uint8_t> is_ground(cloud.size());
#pragma omp parallel for
  for (std::size_t i = 0; i < cloud.size(); ++i)
    for (const Label label : ground)
      is_ground[i] |= distributions.column(Eigen::Index(i))[label - 1] > sure;
  return cloudFeatures(cloud, fitGroundPlane(cloud, is_ground));
}

} // namespace pcl_semantic
