// SPDX-License-Identifier: BSD-3-Clause
#include "support/archives.h"
#include "support/random_scan.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/io/map_archive.h>
#include <pcl_semantic/io/map_export.h>
#include <pcl_semantic/io/map_file.h>

#include <atomic>
#include <thread>

namespace pcl_semantic {

namespace {

constexpr int classes = 3;

// Integrates scans along a line, numbered from `begin`.
void
walk(SemanticVoxelMap& map, int begin, int end)
{
  for (int i = begin; i < end; ++i) {
    const LabelledScan scan = makeRandomScan(400, 5.0f, classes, unsigned(i));
    map.integrate(scan.cloud,
                  Eigen::Isometry3d(Eigen::Translation3d(1e6 + 3.0 * i, -2.0 * i, 0.1)),
                  scan.distributions);
  }
}

std::unique_ptr<SemanticVoxelMap>
makeMap(std::shared_ptr<BlockStore> store = nullptr)
{
  SemanticVoxelMap::Parameters parameters;
  parameters.voxel_size = 0.25;
  parameters.window = {8.0, 8.0, 6.0};
  return std::make_unique<SemanticVoxelMap>(LabelSet({{"a", {}}, {"b", {}}, {"c", {}}}),
                                            parameters, std::move(store));
}

void
expectSameMaps(const SemanticVoxelMap& a, const SemanticVoxelMap& b)
{
  std::map<VoxelIndex, VoxelBlock, VoxelIndexLess> blocks;
  a.forEachBlock(
      [&](const VoxelIndex& index, const VoxelBlock& block) { blocks[index] = block; });
  EXPECT_GT(blocks.size(), 50u);
  std::size_t count = 0;
  b.forEachBlock([&](const VoxelIndex& index, const VoxelBlock& block) {
    ++count;
    ASSERT_EQ(blocks.count(index), 1u);
    EXPECT_TRUE(areSameBlocks(blocks[index], block, classes));
  });
  EXPECT_EQ(count, blocks.size());
  EXPECT_EQ(a.cloudOrigin(), b.cloudOrigin());
}

} // namespace

TEST(MapFile, WhatIsLoadedIsWhatWasSavedAndGoesOn)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("map");
  const auto map = makeMap();
  walk(*map, 0, 8);
  saveMap(*map, path);
  const auto loaded = loadMap(path);
  expectSameMaps(*map, *loaded);
  EXPECT_EQ(loaded->parameters().window, map->parameters().window);
  loaded->moveWindow({1e6 + 21.0, -14.0, 0.1}); // to the last scan
  const VoxelCloud there = map->occupied();
  EXPECT_GT(there.size(), 100u);
  EXPECT_EQ(loaded->occupied().indices, there.indices);
  walk(*map, 4, 12);
  walk(*loaded, 4, 12);
  expectSameMaps(*map, *loaded);
  EXPECT_EQ(thrownMessage<OutputException>([&] { saveMap(*map, path); }),
            path + ": is there already");
}

// A writer that goes to and fro between two places, so that blocks leave for the
// archive and come back, while others read.
TEST(MapFile, ReadersSeeWholeScansOfAMovingMap)
{
  const TemporaryFolder folder;
  const ArchiveHeader header{makeMap()->labelSet(), makeMap()->parameters(), ""};
  const auto archive = MapArchive::create(folder.path("map"), header);
  const auto map = makeMap(archive);
  LabelledScan scan = makeRandomScan(2000, 3.0f, classes, 1);
  const auto integrateAt = [&](int place, Label label) {
    for (Eigen::Index i = 0; i < scan.distributions.size(); ++i)
      scan.distributions.setLabel(i, label, 0.999f);
    map->integrate(scan.cloud,
                   Eigen::Isometry3d(Eigen::Translation3d(40.0 * place, 0, 0)),
                   scan.distributions);
  };
  integrateAt(0, 1);
  integrateAt(1, 1);
  const std::size_t count = map->occupied().size();
  ASSERT_GT(count, 1000u);
  std::atomic<bool> done{false};
  std::atomic<int> reads{0}, torn{0};
  const auto read = [&] {
    while (!done) {
      const VoxelCloud window = map->occupied(), all = map->occupiedEverywhere();
      torn += window.size() != count;
      for (const pcl::PointXYZRGBL& point : *window.cloud)
        torn += point.label != window.cloud->front().label;
      torn += all.size() != 2 * count;
      int of_a_label[classes + 1] = {};
      for (const pcl::PointXYZRGBL& point : *all.cloud)
        ++of_a_label[point.label];
      for (const int voxels : of_a_label)
        torn += std::size_t(voxels) % count != 0;
      ++reads;
    }
  };
  std::thread readers[2] = {std::thread(read), std::thread(read)};
  for (int i = 0; i < 24 || reads < 20; ++i) {
    integrateAt(i % 2, Label(1 + i / 2 % 3));
    const VoxelCloud voxels = map->occupied();
    LabelDistributions refined(classes, Eigen::Index(voxels.size()));
    for (Eigen::Index k = 0; k < refined.size(); ++k)
      refined.setLabel(k, Label(1 + (i + 1) / 2 % 3), 0.9f);
    map->setRefined(voxels, refined);
    map->flush();
    if (i % 5 == 0)
      archive->commit({});
  }
  done = true;
  for (std::thread& reader : readers)
    reader.join();
  EXPECT_EQ(torn, 0);
}

// The archive as the store of a map, against the store in memory.
TEST(MapFile, AMapInAnArchiveIsTheSameMap)
{
  const TemporaryFolder folder;
  const auto plain = makeMap();
  walk(*plain, 0, 12);
  walk(*plain, 2, 9);
  const ArchiveHeader header{plain->labelSet(), plain->parameters(), ""};
  const std::string path = folder.path("map");
  const auto archive = MapArchive::create(path, header);
  const auto map = makeMap(archive);
  for (int i = 0; i < 12; ++i) {
    walk(*map, i, i + 1);
    if (i % 3 == 0) {
      map->flush();
      archive->commit({});
    }
  }
  walk(*map, 2, 9);
  expectSameMaps(*plain, *map);
  map->flush();
  ArchiveState state;
  state.cloud_origin = map->cloudOrigin();
  archive->commit(state);
  expectSameMaps(*plain, *loadMap(path));

  const VoxelCloud voxels = plain->occupiedEverywhere();
  writeVoxelCloud(folder.path("plain.pcd"), voxels, header.label_set,
                  VoxelColour::classes);
  EXPECT_EQ(
      exportVoxels(*archive, {}, folder.path("archive.pcd"), VoxelColour::classes),
      voxels.size());
  EXPECT_TRUE(bytesOf(folder.path("plain.pcd")) == bytesOf(folder.path("archive.pcd")));
  const ArchiveExtent extent = archiveExtent(*archive);
  EXPECT_EQ(extent.voxels, voxels.size());
  Eigen::AlignedBox3d box;
  for (const VoxelIndex& voxel : voxels.indices)
    for (int corner = 0; corner < 2; ++corner)
      box.extend((voxel.cast<double>().array() + corner).matrix() * 0.25);
  EXPECT_TRUE(box.isApprox(extent.box));
}

// Written by the build of 2026-11-26; all later builds must read it.
TEST(MapReader, ReadsAnEarlierArchive)
{
  const std::string path =
      std::string(PCL_SEMANTIC_SOURCE_DIR) + "/test/io/archive_version_2.map";
  EXPECT_TRUE(verifyArchive(path).empty());
  const std::unique_ptr<MapReader> reader = MapReader::open(path);
  EXPECT_EQ(reader->state().blocks, 12u);
  EXPECT_EQ(reader->state().frames, 2u);
  EXPECT_TRUE(reader->state().finished);
  EXPECT_EQ(reader->header().parameters.voxel_size, 1.0);
  const VoxelCloud voxels = readVoxels(*reader, {});
  std::vector<int> labels(12, 0);
  for (const auto& point : *voxels.cloud)
    ++labels[point.label];
  EXPECT_EQ(labels, (std::vector<int>{0, 17, 0, 69, 80, 5, 48, 0, 0, 0, 1, 0}));
  for (Eigen::Index i = 0; i < voxels.refined.size(); ++i)
    EXPECT_EQ(voxels.refined.mapLabel(i), (*voxels.cloud)[std::size_t(i)].label);
}

} // namespace pcl_semantic
