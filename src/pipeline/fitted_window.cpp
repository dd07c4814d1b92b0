// SPDX-License-Identifier: BSD-3-Clause
#include "fitted_window.h"

#include <pcl_semantic/map/map_parameters.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <variant>
#include <vector>

namespace pcl_semantic {

namespace {

// 99.9 % quantile of the distances; 0 without depths.
double
reachOf(const pcl::PointCloud<pcl::PointXYZRGB>& cloud)
{
  std::vector<float> distances;
  for (const pcl::PointXYZRGB& point : cloud) {
    const float distance = point.getVector3fMap().norm();
    if (std::isfinite(distance))
      distances.push_back(distance);
  }
  if (distances.empty())
    return 0.0;
  const auto last =
      distances.begin() + std::ptrdiff_t(0.999 * double(distances.size() - 1));
  std::nth_element(distances.begin(), last, distances.end());
  return double(*last);
}

} // namespace

std::optional<double>
reachOfDepths(FrameSource& source)
{
  constexpr std::size_t samples = 10;
  const std::size_t frames = source.frames().size();
  double reach = 0.0;
  for (std::size_t k = 0; k < std::min(samples, frames); ++k) {
    source.seek(k * frames / std::min(samples, frames));
    const std::optional<SensorFrame> frame = source.next();
    if (const auto* const rgbd = frame ? std::get_if<RgbdFrame>(&*frame) : nullptr)
      reach = std::max(reach, reachOf(*rgbd->cloud));
  }
  source.seek(0);
  return reach > 0.0 ? std::optional<double>(reach) : std::nullopt;
}

Eigen::Vector3d
windowOfReach(double reach, double max_range)
{
  MapParameters parameters;
  parameters.max_range = std::min(reach, max_range);
  return parameters.withWindow().window;
}

} // namespace pcl_semantic
