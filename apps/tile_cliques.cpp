// SPDX-License-Identifier: BSD-3-Clause
#include "tile_cliques.h"

#include <pcl/common/io.h>

#include <algorithm>
#include <memory>

namespace pcl_semantic::tool {

void
setMeanPositions(const LabelledCloud& cloud, CliqueGenerator& generator)
{
  const auto means = std::make_shared<CliqueGenerator::Cloud>();
  pcl::copyPointCloud(*cloud.cloud, *means);
  generator.setMeanPositions(means, cloud.table.voxel_grid[0]);
}

std::vector<pcl::PointIndices>
cliquesOf(const LabelledCloud& cloud, CliqueGenerator& generator)
{
  CliqueGenerator::Cloud points;
  pcl::copyPointCloud(*cloud.cloud, points);
  generator.setOrigin(cloud.origin);
  return generator.generate(points);
}

std::size_t
countOwn(const pcl::PointIndices& clique, std::size_t own)
{
  return std::size_t(
      std::count_if(clique.indices.begin(), clique.indices.end(),
                    [&](pcl::index_t i) { return std::size_t(i) < own; }));
}

CliqueCounts
countCliques(const std::vector<pcl::PointIndices>& cliques, std::size_t own)
{
  CliqueCounts counts;
  for (const pcl::PointIndices& clique : cliques) {
    const std::size_t of_tile = countOwn(clique, own);
    counts.of_tile += of_tile > 0;
    counts.cut += of_tile > 0 && of_tile < clique.indices.size();
  }
  return counts;
}

} // namespace pcl_semantic::tool
