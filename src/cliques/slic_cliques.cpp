// SPDX-License-Identifier: BSD-3-Clause
#include "slic_cliques.h"

#include "organized_image.h"

namespace pcl_semantic {

SlicCliques::SlicCliques(const SlicParameters& parameters, const DepthJumps& jumps)
    : parameters_(parameters), jumps_(jumps)
{
  parameters_.validate();
  jumps_.validate();
}

std::vector<pcl::PointIndices>
SlicCliques::generate(const Cloud& cloud)
{
  if (cloud.empty())
    return {};
  const cv::Mat segments = slicSuperpixels(imageOf(cloud), parameters_);
  const SurfaceParts parts = splitAtDepthJumps(segments, cloud, jumps_);
  std::vector<pcl::PointIndices> cliques(std::size_t(parts.count));
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (const int part = parts.numbers.ptr<int>()[i]; part >= 0)
      cliques[std::size_t(part)].indices.push_back(pcl::index_t(i));
  return cliques;
}

} // namespace pcl_semantic
