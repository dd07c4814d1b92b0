// SPDX-License-Identifier: BSD-3-Clause
#include "cliques/supervoxel_clustering.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace pcl_semantic {

namespace {

template <typename PointT>
pcl::PointCloud<pcl::PointXYZL>
clusterOf(const pcl::PointCloud<pcl::PointXYZRGB>& cloud)
{
  const auto input = std::make_shared<pcl::PointCloud<PointT>>();
  pcl::copyPointCloud(cloud, *input);
  pcl::SupervoxelClustering<PointT> clustering(0.1f, 0.5f);
  clustering.setUseSingleCameraTransform(false);
  clustering.setInputCloud(input);
  std::map<std::uint32_t, typename pcl::Supervoxel<PointT>::Ptr> supervoxels;
  clustering.extract(supervoxels);
  return *clustering.getLabeledCloud();
}

} // namespace

// Of PCL's library, and of the code that is compiled here.
TEST(SupervoxelClustering, IsWhatPclsLibraryGives)
{
#if !defined(__x86_64__)
  GTEST_SKIP() << "PCL's library may round otherwise: it fuses multiplications here";
#endif
  for (const unsigned seed : {1u, 2u, 3u}) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(0.0f, 3.0f);
    pcl::PointCloud<pcl::PointXYZRGB> cloud;
    for (int i = 0; i < 20000; ++i) {
      pcl::PointXYZRGB point;
      point.getVector3fMap() << place(random), place(random), 0.1f * place(random);
      point.r = std::uint8_t(80.0f * point.x);
      point.g = std::uint8_t(random() % 256);
      point.b = std::uint8_t(random() % 20);
      cloud.push_back(point);
    }
    const auto ours = clusterOf<SupervoxelPoint>(cloud);
    const auto theirs = clusterOf<pcl::PointXYZRGB>(cloud);
    ASSERT_EQ(ours.size(), theirs.size());
    std::map<std::uint32_t, int> sizes;
    for (std::size_t i = 0; i < ours.size(); ++i) {
      ASSERT_EQ(ours[i].label, theirs[i].label) << "point " << i;
      ++sizes[ours[i].label];
    }
    EXPECT_GT(sizes.size(), 20u);
  }
}

} // namespace pcl_semantic
