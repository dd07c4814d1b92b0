// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/map_cliques.h"
#include "support/thrown_message.h"

#include <gtest/gtest.h>

namespace pcl_semantic {
namespace {

const LabelSet label_set({{"road", {}}, {"wall", {}}, {"pole", {}}});

// Two cubes of 1 m: a floor at z = 0.05 m, and a wall that faces the camera 2 m on.
VoxelCloud
floorAndWall()
{
  VoxelCloud voxels;
  voxels.voxel_size = 0.1;
  for (int a = 0; a < 10; ++a)
    for (int b = 0; b < 10; ++b)
      voxels.indices.push_back({a, b, 0});
  for (int a = 0; a < 10; ++a)
    for (int b = 0; b < 10; ++b)
      voxels.indices.push_back({25, a, b});
  voxels.measured = LabelDistributions(3, Eigen::Index(voxels.size()));
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    pcl::PointXYZRGBL point;
    point.x = 0.1f * (float(voxels.indices[i].x()) + 0.5f);
    point.y = 0.1f * (float(voxels.indices[i].y()) + 0.5f);
    point.z = 0.1f * (float(voxels.indices[i].z()) + 0.5f);
    point.r = i % 2 ? 20 : 40; // on average 30
    point.g = i < 100 ? 60 : 120;
    point.b = 10;
    voxels.cloud->push_back(point);
    voxels.measured.matrix().col(Eigen::Index(i)) << (i < 100 ? 0.7f : 0.1f),
        (i < 100 ? 0.2f : 0.8f), 0.1f;
  }
  return voxels;
}

MapperConfig
cubes()
{
  MapperConfig config;
  config.cliques = "cubes:1";
  return config;
}

TEST(MapCliques, LeavesOutWhatIsLikelyOfAClass)
{
  VoxelCloud voxels = floorAndWall();
  for (int i = 0; i < 200; ++i) // all of the wall, and five of the floor
    if (i < 5 || i >= 100)
      voxels.measured.matrix().col(i) << 0.4f, 0.2f, 0.4f;
  MapperConfig config = cubes();
  EXPECT_EQ(MapCliques(config, label_set).generate(voxels).size(), 2u);
  config.clique_exclude = "pole";
  const auto cliques = MapCliques(config, label_set).generate(voxels);
  ASSERT_EQ(cliques.size(), 1u);
  ASSERT_EQ(cliques[0].indices.size(), 95u);
  EXPECT_EQ(cliques[0].indices[0], 5);
}

TEST(MapCliques, RefusesWhatDoesNotFitTheLabelSet)
{
  MapperConfig config = cubes();
  config.clique_exclude = "pole,lawn";
  expectBadParameter("class 'lawn' is not in the label set",
                     [&] { MapCliques(config, label_set); });
}

} // namespace
} // namespace pcl_semantic
