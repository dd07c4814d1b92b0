// SPDX-License-Identifier: BSD-3-Clause
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
  std::vector<Eigen::Vector3d> points;
  std::vector<std::size_t> pixels;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud[i].z <= max_depth) { // false for NaN
      points.push_back(T_world_camera * cloud[i].getVector3fMap().cast<double>());
      pixels.push_back(i);
    }
  const std::vector<Label> found = map.labels(points);
  for (std::size_t i = 0; i < found.size(); ++i)
    labels.data[pixels[i]] = found[i];
  return labels;
}

} // namespace pcl_semantic
