// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/map_cliques.h"

#include <gtest/gtest.h>

namespace pcl_semantic {
namespace {

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
configOf(const std::string& cliques)
{
  MapperConfig config;
  config.cliques = cliques;
  return config;
}

TEST(MapCliques, CubesAreThoseOfTheCentres)
{
  VoxelCloud voxels = floorAndWall();
  for (pcl::PointXYZRGBL& point : *voxels.cloud)
    point.z -= 0.06f; // below the voxel, as rounding may do
  EXPECT_EQ(MapCliques(configOf("cubes:1")).generate(voxels).size(), 2u);
}

TEST(MapCliques, PlanesUseTheMeanPositions)
{
  VoxelCloud voxels = floorAndWall();
  for (std::size_t i = 0; i < 100; ++i) // the floor leans, beyond its voxels
    (*voxels.cloud)[i].z = 0.05f + 0.5f * (*voxels.cloud)[i].x;
  MapCliques planes(configOf("planes:100"));
  const auto cliques = planes.generate(voxels);
  ASSERT_EQ(cliques.size(), 2u);
  for (std::size_t i = 0; i < 100; ++i)
    (*voxels.cloud)[i].z = 10.0f * float(i % 7); // no plane
  EXPECT_EQ(planes.generate(voxels).size(), 1u);
}

TEST(MapCliques, LaterMethodsGetTheRest)
{
  VoxelCloud voxels = floorAndWall();
  for (std::size_t i = 0; i < 100; ++i)
    (*voxels.cloud)[i].z = 10.0f * float(i % 7); // no plane
  const auto cliques = MapCliques(configOf("planes,cubes:1")).generate(voxels);
  std::vector<int> counts(voxels.size(), 0);
  for (const pcl::PointIndices& clique : cliques)
    for (const pcl::index_t i : clique.indices)
      ++counts[std::size_t(i)];
  EXPECT_EQ(counts, std::vector<int>(voxels.size(), 1));
}

} // namespace
} // namespace pcl_semantic
