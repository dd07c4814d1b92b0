// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/things/plane_cliques.h>

#include "core/fail.h"

#include <pcl_semantic/cliques/cube_cliques.h>

#include <cmath>
#include <utility>

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
  PlaneExtraction<pcl::PointXYZRGB> extraction;
  PlaneParameters parameters = parameters_;
  if (parameters.radius == 0.0 && voxel_size_ > 0.0)
    parameters.radius = PlaneParameters::automaticRadius(voxel_size_);
  extraction.setParameters(parameters);
  extraction.setInputCloud(meansOr(cloud).makeShared());
  CubeCliques cubes(std::isinf(edge_) ? 1.0 : edge_);
  configure(cubes);
  cubes.setInputCloud(cloud.makeShared());
  std::vector<pcl::PointIndices> cliques;
  for (ExtractedPlane& plane : extraction.extract()) {
    std::vector<pcl::PointIndices> pieces(1);
    pieces[0].indices = plane.indices;
    if (!std::isinf(edge_)) {
      cubes.setIndices(pcl::make_shared<pcl::Indices>(std::move(plane.indices)));
      cubes.extract(pieces);
    }
    for (pcl::PointIndices& piece : pieces)
      cliques.push_back(std::move(piece));
  }
  return cliques;
}

} // namespace pcl_semantic
