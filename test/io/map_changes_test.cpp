// SPDX-License-Identifier: BSD-3-Clause
#include "support/archives.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/io/map_changes.h>

#include <gtest/gtest.h>

#include <set>

namespace pcl_semantic {

namespace {

const Eigen::Isometry3d still = Eigen::Isometry3d::Identity();

using Voxels = std::set<std::array<int, 3>>;

// A map of a room of 16 x 16 x 16 voxels: these are occupied, the others free.
std::string
writeRoom(const std::string& path, const Voxels& occupied)
{
  const auto archive = MapArchive::create(path, makeArchiveHeader());
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 2; ++x) {
        VoxelBlock block;
        block.log_odds.fill(-4000);
        for (int offset = 0; offset < kBlockVoxels; ++offset) {
          const VoxelIndex voxel = voxelAt({x, y, z}, offset);
          if (occupied.count({voxel.x(), voxel.y(), voxel.z()}) == 0)
            continue;
          block.log_odds[std::size_t(offset)] = 4000;
          const int record = block.makeRecord(offset, 3);
          block.records[std::size_t(record)].observations = 1;
          block.refined[std::size_t(3 * record + 1)] = 1.0f; // car
        }
        archive->put({x, y, z}, block);
      }
  archive->commit({});
  return path;
}

Voxels
voxelsOf(const MapChanges& changes, std::size_t begin, std::size_t end)
{
  Voxels voxels;
  for (std::size_t i = begin; i < end; ++i) {
    const VoxelIndex& voxel = changes.voxels.indices[i];
    voxels.insert({voxel.x(), voxel.y(), voxel.z()});
  }
  return voxels;
}

TEST(MapChanges, AreWhatOneSawOccupiedAndTheOtherFree)
{
  const TemporaryFolder folder;
  const Voxels wall = {{1, 1, 1}, {1, 2, 1}, {1, 3, 1}};
  const Voxels car = {{7, 7, 7}, {8, 7, 7}, {8, 8, 8}}, tree = {{12, 3, 9}};
  Voxels before = wall, after = {{2, 1, 1}, {2, 2, 1}, {2, 3, 1}}; // the wall, one off
  before.insert(car.begin(), car.end());
  after.insert(tree.begin(), tree.end());
  const std::string a = writeRoom(folder.path("a"), before),
                    b = writeRoom(folder.path("b"), after);
  const MapChanges changes = findChanges({a, still}, {b, still});
  EXPECT_EQ(changes.went, 3u);
  EXPECT_EQ(changes.came, 1u);
  ASSERT_EQ(changes.voxels.size(), 4u);
  EXPECT_EQ(voxelsOf(changes, 0, 3), car);
  EXPECT_EQ(voxelsOf(changes, 3, 4), tree);
  EXPECT_EQ((*changes.voxels.cloud)[0].label, 2u);
  EXPECT_EQ((*changes.voxels.cloud)[0].r, 220);
  EXPECT_EQ((*changes.voxels.cloud)[3].g, 180);
  EXPECT_EQ(findChanges({a, still}, {a, still}).voxels.size(), 0u);
}

TEST(MapChanges, AreFoundWhereTheMapsAreMovedTo)
{
  const TemporaryFolder folder;
  const std::string a = writeRoom(folder.path("a"), {{3, 3, 3}, {9, 9, 9}}),
                    b = writeRoom(folder.path("b"), {{5, 3, 3}, {11, 9, 9}});
  const Eigen::Isometry3d motion(Eigen::Translation3d(-0.5, 0.0, 0.0)); // two voxels
  EXPECT_EQ(findChanges({a, still}, {b, still}).voxels.size(), 4u);
  EXPECT_EQ(findChanges({a, still}, {b, motion}).voxels.size(), 0u);
  ArchiveHeader header = makeArchiveHeader();
  header.parameters.voxel_size = 0.5; // another
  createWith(folder.path("c"), {}, header);
  EXPECT_THROW(findChanges({a, still}, {folder.path("c"), still}), BadInputException);
}

} // namespace

} // namespace pcl_semantic
