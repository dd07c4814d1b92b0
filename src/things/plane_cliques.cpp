// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/things/plane_cliques.h>

#include "core/fail.h"

#include <pcl_semantic/cliques/cube_cliques.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

PlaneCliques::PlaneCliques(double edge, const PlaneParameters& parameters)
    : edge_(edge), parameters_(parameters)
{
  if (!(edge > 0.0))
    badParameter("plane cliques: edge is ", edge, " m, expected a positive number");
  parameters.validate();
}

std::vector<pcl::PointIndices>
PlaneCliques::generate(const Cloud& cloud)
{
  judgeSteps("PlaneCliques", cloud);
  std::vector<int> cube_of_point(cloud.size(), 0); // in the order of the cubes
  if (!std::isinf(edge_)) {
    CubeCliques cubes(edge_);
    cubes.setOrigin(origin_);
    const std::vector<pcl::PointIndices> found = cubes.generate(cloud);
    for (std::size_t c = 0; c < found.size(); ++c)
      for (const pcl::index_t i : found[c].indices)
        cube_of_point[std::size_t(i)] = int(c);
  }
  PlaneParameters parameters = parameters_;
  if (parameters.radius == 0.0 && voxel_size_ > 0.0)
    parameters.radius = PlaneParameters::automaticRadius(voxel_size_);
  PlaneExtraction<pcl::PointXYZRGB> extraction;
  extraction.setParameters(parameters);
  extraction.setInputCloud(meansOr(cloud).makeShared());
  std::vector<pcl::PointIndices> cliques;
  for (ExtractedPlane& plane : extraction.extract()) {
    pcl::Indices& indices = plane.indices;
    const auto cubeOf = [&](pcl::index_t i) { return cube_of_point[std::size_t(i)]; };
    std::stable_sort(
        indices.begin(), indices.end(),
        [&](pcl::index_t a, pcl::index_t b) { return cubeOf(a) < cubeOf(b); });
    for (auto first = indices.begin(); first != indices.end();) {
      const auto last = std::find_if(first, indices.end(), [&](pcl::index_t i) {
        return cubeOf(i) != cubeOf(*first);
      });
      cliques.emplace_back();
      cliques.back().indices.assign(first, last);
      first = last;
    }
  }
  return cliques;
}

} // namespace pcl_semantic
