// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/map/semantic_voxel_map.h>

namespace ps = pcl_semantic;

int
main()
{
  ps::SemanticVoxelMap map(ps::LabelSet({{"road", {}}, {"wall", {}}}),
                           ps::SemanticVoxelMap::Parameters());
  pcl::PointCloud<pcl::PointXYZ> cloud;
  cloud.push_back({4.05f, 0.0f, 0.0f});
  ps::LabelDistributions labels(2, 1);
  labels.setLabel(0, 2, 0.8f);
  map.integrate(cloud, Eigen::Isometry3d::Identity(), labels);
  return map.occupied().size() == 1 ? 0 : 1;
}
