/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/cliques/slic_cliques.h>
#include <pcl_semantic/core/exceptions.h>

#include <pcl/common/point_tests.h>

#include <algorithm>

namespace pcl_semantic {

namespace {

cv::Mat
imageOf(const CliqueGenerator::Cloud& cloud)
{
  cv::Mat image(int(cloud.height), int(cloud.width), CV_8UC3);
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      const pcl::PointXYZRGB& point = cloud(std::size_t(u), std::size_t(v));
      image.at<cv::Vec3b>(v, u) = {point.b, point.g, point.r};
    }
  return image;
}

} // namespace

SlicCliques::SlicCliques(const SlicParameters& parameters) : parameters_(parameters)
{
  parameters_.validate();
}

std::vector<pcl::PointIndices>
SlicCliques::generate(const Cloud& cloud)
{
  if (cloud.empty())
    return {};
  if (!cloud.isOrganized())
    PCL_THROW_EXCEPTION(BadInputException,
                        "superpixels need an organized cloud, an image of points; this "
                        "one is a list of "
                            << cloud.size());
  std::vector<pcl::PointIndices> cliques =
      cliquesOfSegments(slicSuperpixels(imageOf(cloud), parameters_));
  for (pcl::PointIndices& clique : cliques)
    clique.indices.erase(
        std::remove_if(clique.indices.begin(), clique.indices.end(),
                       [&](pcl::index_t i) { return !pcl::isXYZFinite(cloud[i]); }),
        clique.indices.end());
  cliques.erase(std::remove_if(cliques.begin(), cliques.end(),
                               [](const pcl::PointIndices& clique) {
                                 return clique.indices.empty();
                               }),
                cliques.end());
  return cliques;
}

} // namespace pcl_semantic
