// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/map/semantic_voxel_map.h>

#include <pcl/type_traits.h>

namespace pcl_semantic {

namespace detail {

template <typename PointT>
Scan
makeScan(const pcl::PointCloud<PointT>& cloud)
{
  using pcl::traits::offset;
  constexpr std::size_t x = offset<PointT, pcl::fields::x>::value;
  static_assert(offset<PointT, pcl::fields::y>::value == x + sizeof(float) &&
                    offset<PointT, pcl::fields::z>::value == x + 2 * sizeof(float),
                "x, y and z of a point have to lie side by side");
  Scan scan;
  if (cloud.empty())
    return scan;
  scan.points = {&cloud[0].x, cloud.size(), sizeof(PointT)};
  if constexpr (pcl::traits::has_color<PointT>::value)
    scan.rgb = {&cloud[0].rgba, cloud.size(), sizeof(PointT)};
  return scan;
}

} // namespace detail

template <typename PointT>
ScanCounts
SemanticVoxelMap::integrate(const pcl::PointCloud<PointT>& cloud,
                            const Eigen::Isometry3d& T_world_sensor,
                            const LabelDistributions& distributions,
                            const std::vector<float>& deviations)
{
  Scan scan = detail::makeScan(cloud);
  if (distributions.classes() > 0) // 0 classes: a scan without labels
    scan.distributions = &distributions;
  if (!deviations.empty())
    scan.deviations = &deviations;
  return integrateScan(scan, T_world_sensor);
}

template <typename PointT>
std::size_t
SemanticVoxelMap::addLabels(const pcl::PointCloud<PointT>& cloud,
                            const Eigen::Isometry3d& T_world_sensor,
                            const LabelDistributions& distributions)
{
  Scan scan = detail::makeScan(cloud);
  scan.distributions = &distributions;
  return addScanLabels(scan, T_world_sensor);
}

} // namespace pcl_semantic
