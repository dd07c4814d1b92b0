// SPDX-License-Identifier: BSD-3-Clause
#include "slic_cliques.h"
#include "core/cloud_size.h"
#include "core/fail.h"

#include <pcl_semantic/superpixels/depth_jumps.h>

namespace pcl_semantic {

void
requireOrganized(const CliqueGenerator::Cloud& cloud)
{
  if (!cloud.empty() && !cloud.isOrganized())
    badInput("superpixels need an organized cloud, an image of points; this "
             "one is a list of ",
             cloud.size());
  requireCloudSize(cloud);
}

cv::Mat
slicSuperpixels(const CliqueGenerator::Cloud& cloud, const SlicParameters& parameters)
{
  requireOrganized(cloud);
  cv::Mat3b image(int(cloud.height), int(cloud.width));
#pragma omp parallel for schedule(static)
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      const pcl::PointXYZRGB& point = cloud(std::size_t(u), std::size_t(v));
      image(v, u) = {point.b, point.g, point.r};
    }
  return slicSuperpixels(image, parameters);
}

SlicCliques::SlicCliques(const SlicParameters& parameters) : parameters_(parameters)
{
  parameters_.validate();
}

std::vector<pcl::PointIndices>
SlicCliques::generate(const Cloud& cloud)
{
  if (cloud.empty())
    return {};
  const cv::Mat segments = slicSuperpixels(cloud, parameters_);
  const SurfaceParts parts = splitAtDepthJumps(segments, cloud, DepthJumps());
  std::vector<pcl::PointIndices> cliques(std::size_t(parts.count));
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (const int part = parts.numbers.ptr<int>()[i]; part >= 0)
      cliques[std::size_t(part)].indices.push_back(pcl::index_t(i));
  return cliques;
}

} // namespace pcl_semantic
