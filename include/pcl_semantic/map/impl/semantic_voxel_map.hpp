/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/map/semantic_voxel_map.h>

#include <pcl/type_traits.h>

namespace pcl_semantic {

namespace detail {

template <typename PointT>
Scan
makeScan(const pcl::PointCloud<PointT>& cloud)
{
  Scan scan;
  scan.points.resize(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
    scan.points[i] = {cloud[i].x, cloud[i].y, cloud[i].z};
  if constexpr (pcl::traits::has_color<PointT>::value) {
    scan.rgb.resize(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i)
      scan.rgb[i] = cloud[i].rgba;
  }
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
  if (!distributions.empty())
    scan.distributions = &distributions;
  if (!deviations.empty())
    scan.deviations = &deviations;
  return integrateScan(scan, T_world_sensor);
}

} // namespace pcl_semantic
