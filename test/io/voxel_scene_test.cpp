// SPDX-License-Identifier: BSD-3-Clause
#include "files/pcd_file.h"
#include "support/ascii_cloud.h"
#include "support/random_scan.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/io/voxel_cloud_file.h>
#include <pcl_semantic/io/voxel_scene.h>

#include <gtest/gtest.h>

#include <algorithm>

using namespace pcl_semantic;

namespace {

const LabelSet label_set({{"a", {}}, {"b", {}}, {"c", {}}});
const Eigen::Vector3d place(5003.0, -2.0, 0.1);

// Two scans near each other: all of it is in the window.
std::unique_ptr<SemanticVoxelMap>
makeMap()
{
  SemanticVoxelMap::Parameters parameters;
  parameters.voxel_size = 0.2;
  parameters.window = {16.0, 16.0, 16.0};
  auto map = std::make_unique<SemanticVoxelMap>(label_set, parameters);
  for (const unsigned seed : {1u, 2u}) {
    const LabelledScan scan = makeRandomScan(300, 4.0f, 3, seed);
    map->integrate(scan.cloud, Eigen::Isometry3d(Eigen::Translation3d(place)),
                   scan.distributions);
  }
  return map;
}

std::vector<VoxelIndex>
sorted(std::vector<VoxelIndex> voxels)
{
  std::sort(voxels.begin(), voxels.end(), VoxelIndexLess());
  return voxels;
}

} // namespace

TEST(VoxelScene, HoldsWhatAMapKnows)
{
  const auto map = makeMap();
  std::vector<VoxelIndex> free, occupied;
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(6.0);
  for (const VoxelState& state : map->states({place - reach, place + reach}))
    (state.occupancy == Occupancy::free ? free : occupied).push_back(state.index);
  ASSERT_GT(free.size(), 1000u);
  ASSERT_GT(occupied.size(), 300u);
  const VoxelScene scene = sceneOf(*map, true);
  EXPECT_TRUE(scene.knows_free);
  EXPECT_EQ(sorted(scene.free), sorted(free));
  EXPECT_EQ(sorted(scene.voxels.indices), sorted(occupied));
  EXPECT_EQ(scene.origin, Eigen::Vector3d(5000, 0, 0));
  for (std::size_t i = 0; i < scene.voxels.size(); ++i) {
    const Eigen::Vector3d centre = centreOf(scene.grid, scene.voxels.indices[i]);
    EXPECT_EQ(map->voxelOf(centre + scene.origin), scene.voxels.indices[i]);
    const Eigen::Vector3f point = (*scene.voxels.cloud)[i].getVector3fMap();
    EXPECT_LE((centre.cast<float>() - point).cwiseAbs().maxCoeff(), 0.1001f);
    EXPECT_EQ(map->voxelOf(point.cast<double>() + scene.origin),
              scene.voxels.indices[i]);
  }
  const VoxelScene without = sceneOf(*map);
  EXPECT_FALSE(without.knows_free);
  EXPECT_TRUE(without.free.empty());
}

TEST(VoxelScene, FindsTheGridThatOurMapsHave)
{
  const TemporaryFolder folder;
  const auto map = makeMap();
  const VoxelCloud voxels = map->occupiedEverywhere();
  writeVoxelCloud(folder.path("a.pcd"), voxels, label_set, VoxelColour::measured);
  const VoxelScene scene = readVoxelScene(folder.path("a.pcd"));
  EXPECT_EQ(scene.grid.size, 0.2);
  EXPECT_EQ(scene.grid.corner, Eigen::Vector3d(-5000, 0, 0));
  EXPECT_EQ(scene.voxels.indices, voxels.indices);
}

// Without the header's comment, which other programs drop, centres tell the grid.
TEST(VoxelScene, FindsTheGridOfCentres)
{
  const TemporaryFolder folder;
  const auto map = makeMap();
  VoxelCloud voxels = map->occupiedEverywhere();
  const std::string path = folder.path("a.pcd");
  writeVoxelCloud(path, voxels, label_set, VoxelColour::measured);
  PcdTable table = readPcd(path);
  table.voxel_grid = {};
  writeCloudTable(path, table);
  expectBadInput("points are not voxel centres; give the voxel size",
                 [&] { readVoxelScene(path); });
  EXPECT_EQ(readVoxelScene(path, {0.2}).voxels.size(), voxels.size());
  voxels.moveToCentres();
  writeVoxelCloud(path, voxels, label_set, VoxelColour::measured);
  table = readPcd(path);
  table.voxel_grid = {};
  writeCloudTable(path, table);
  const VoxelScene scene = readVoxelScene(path);
  EXPECT_EQ(scene.grid.size, 0.2);
  EXPECT_EQ(scene.grid.corner, Eigen::Vector3d::Zero()); // not 2e-8
  ASSERT_EQ(scene.voxels.size(), voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i)
    EXPECT_EQ(scene.voxels.indices[i] + VoxelIndex(25000, 0, 0), voxels.indices[i]);
}

TEST(VoxelScene, AsksForTheSizeIfTheHeadersGridIsSpoilt)
{
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "a.pcd", "# voxel_grid 0.2 0 x 0\n" +
                   asciiCloud("x y z", "0.0137 0.0229 0.0571\n0.3313 0.1091 0.0717\n"
                                       "0.5353 0.1879 0.1997\n"));
  const std::string message =
      thrownMessage<BadInputException>([&] { readVoxelScene(path); });
  EXPECT_TRUE(holds(message, path));
  EXPECT_TRUE(holds(message, "give the voxel size"));
  EXPECT_EQ(readVoxelScene(path, {0.2}).voxels.size(), 3u);
}
