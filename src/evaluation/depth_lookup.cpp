/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/depth_lookup.h>

namespace pcl_semantic {

cv::Mat
labelsAtDepth(const SemanticVoxelMap& map,
              const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
              const Eigen::Isometry3d& T_world_camera, double max_depth)
{
  if (!cloud.isOrganized())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "looking labels up at depth needs an organized cloud");
  const int width = static_cast<int>(cloud.width);
  const int height = static_cast<int>(cloud.height);
  cv::Mat labels = cv::Mat::zeros(height, width, CV_8UC1);
#pragma omp parallel for schedule(dynamic, 8)
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const pcl::PointXYZRGB& point = cloud(u, v);
      if (point.z <= max_depth) // false for NaN
        labels.at<std::uint8_t>(v, u) =
            map.label(T_world_camera * point.getVector3fMap().cast<double>());
    }
  return labels;
}

} // namespace pcl_semantic
