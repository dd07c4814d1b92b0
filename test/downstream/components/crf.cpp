// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/cliques/supervoxel_cliques.h>
#include <pcl_semantic/filters/label_voxel_grid.h>
#include <pcl_semantic/filters/semantic_crf.h>

int
main()
{
  pcl::PointCloud<pcl::PointXYZL>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZL>);
  for (int i = 0; i < 9; ++i)
    cloud->push_back({0.1f * float(i), 0.0f, 0.0f, i == 4 ? 1u : 2u});
  pcl_semantic::SemanticCRF<pcl::PointXYZL> crf;
  crf.setLabelConfidence(0.8, 2);
  crf.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointXYZL> refined;
  crf.filter(refined);
  return refined[4].label == 2u ? 0 : 1;
}
