// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/temporary_folder.h"

#include <pcl_semantic/io/map_archive.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <vector>

namespace pcl_semantic {

/** \brief A block with random values of a map, with \a records records at random
 * voxels, in random order. */
inline VoxelBlock
makeRandomBlock(std::size_t records, int classes, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> log_value(-9.2f, 0.0f), share(0.0f, 1.0f);
  VoxelBlock block;
  for (StoredLogOdds& value : block.log_odds)
    value = random() % 4 == 0 ? kUnknown : StoredLogOdds(int(random() % 28000) - 14000);
  std::vector<int> places(kBlockVoxels);
  for (int i = 0; i < kBlockVoxels; ++i)
    places[std::size_t(i)] = i;
  std::shuffle(places.begin(), places.end(), random);
  for (std::size_t i = 0; i < records; ++i) {
    const int record = block.makeRecord(places[i], classes);
    VoxelRecord& values = block.records[std::size_t(record)];
    for (std::uint32_t& sum : values.colour_sum)
      sum = std::uint32_t(random());
    values.colour_count = std::uint32_t(random()) >> 10;
    values.observations = std::uint32_t(random()) >> (random() % 32);
    values.label_observations = values.observations / 2;
    for (std::uint16_t& coordinate : values.position)
      coordinate = std::uint16_t(random());
    values.label_deviation = std::uint16_t(random() % 3 * 1000);
    for (int k = 0; k < classes; ++k) {
      block.measured[std::size_t(record * classes + k)] =
          k == record % classes ? 0.0f : log_value(random);
      block.refined[std::size_t(record * classes + k)] =
          record % 3 == 0 ? 0.0f : share(random);
    }
  }
  return block;
}

/** \brief Whether two blocks have bit-identical values, in any order of their records.
 */
inline bool
areSameBlocks(const VoxelBlock& a, const VoxelBlock& b, int classes)
{
  if (a.log_odds != b.log_odds || a.records.size() != b.records.size())
    return false;
  const auto same = [&](const std::vector<float>& x, int i, const std::vector<float>& y,
                        int j) {
    return std::equal(x.begin() + i * classes, x.begin() + (i + 1) * classes,
                      y.begin() + j * classes);
  };
  for (int place = 0; place < kBlockVoxels; ++place) {
    const int i = a.recordAt(place), j = b.recordAt(place);
    if ((i == VoxelBlock::kNoRecord) != (j == VoxelBlock::kNoRecord))
      return false;
    if (i == VoxelBlock::kNoRecord)
      continue;
    const VoxelRecord &p = a.records[std::size_t(i)], &q = b.records[std::size_t(j)];
    if (p.colour_sum != q.colour_sum || p.colour_count != q.colour_count ||
        p.observations != q.observations ||
        p.label_observations != q.label_observations || p.position != q.position ||
        p.label_deviation != q.label_deviation || !same(a.measured, i, b.measured, j) ||
        !same(a.refined, i, b.refined, j))
      return false;
  }
  return true;
}

inline LabelSet
threeClasses()
{
  return LabelSet({{"road", {128, 64, 128}, false, false},
                   {"car", {64, 0, 128}, false, true},
                   {"sky", {128, 128, 128}, true, false}});
}

inline ArchiveHeader
makeArchiveHeader()
{
  ArchiveHeader header;
  header.label_set = threeClasses();
  header.parameters.voxel_size = 0.25;
  header.configuration = "sequence: here\nvoxel_size: 0.25\n";
  return header;
}

/** \brief A still object of class "car" that is a block of voxels. */
inline MapObject
makeMapObject(std::uint32_t number, const VoxelIndex& corner, const VoxelIndex& size)
{
  MapObject object;
  object.number = number;
  object.label = 2;
  object.summary.first_frame = 3;
  object.summary.last_frame = 7;
  object.summary.frames = 4;
  for (int z = 0; z < size.z(); ++z)
    for (int y = 0; y < size.y(); ++y)
      for (int x = 0; x < size.x(); ++x) {
        object.voxels.push_back(corner + VoxelIndex(x, y, z));
        object.observations.push_back(std::uint32_t(1 + x));
      }
  return object;
}

/** \brief Objects numbered from 1. */
inline MapObjects
makeMapObjects(std::vector<MapObject> objects)
{
  MapObjects all;
  all.last_number = std::uint32_t(objects.size());
  all.frames = 8;
  all.min_voxels = 2;
  all.objects = std::move(objects);
  return all;
}

using Blocks = std::map<VoxelIndex, VoxelBlock, VoxelIndexLess>;

/** \brief Random blocks around the origin and at the farthest corners. */
inline Blocks
makeRandomBlocks(std::size_t count, unsigned seed)
{
  std::mt19937 random(seed);
  Blocks blocks;
  const auto coordinate = [&] {
    return random() % 5 == 0 ? (random() % 2 ? 1 : -1) * 125000000
                             : int(random() % 50) - 25;
  };
  while (blocks.size() < count) {
    const VoxelIndex index(coordinate(), coordinate(), coordinate());
    const std::size_t records[] = {0, 1, random() % 100, 512};
    blocks[index] = makeRandomBlock(records[random() % 4], 3, unsigned(random()));
  }
  return blocks;
}

inline void
putAll(const Blocks& blocks, MapArchive& archive)
{
  for (const auto& [index, block] : blocks)
    archive.put(index, block);
}

/** \brief A new archive, open for writing, that has committed these blocks. */
inline std::shared_ptr<MapArchive>
createWith(const std::string& path, const Blocks& blocks,
           const ArchiveHeader& header = makeArchiveHeader(),
           const ArchiveState& state = {})
{
  std::shared_ptr<MapArchive> archive = MapArchive::create(path, header);
  putAll(blocks, *archive);
  archive->commit(state);
  return archive;
}

/** \brief EXPECTs exactly these blocks, in order, from forEach() and get(). */
inline void
expectHolds(const BlockStore& store, const Blocks& blocks)
{
  auto expected = blocks.begin();
  store.forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    ASSERT_NE(expected, blocks.end());
    EXPECT_EQ(index, expected->first);
    EXPECT_TRUE(areSameBlocks(block, expected->second, 3));
    EXPECT_FALSE(block.changed);
    ++expected;
  });
  EXPECT_EQ(expected, blocks.end());
  for (const auto& [index, block] : blocks) {
    const auto got = store.get(index);
    ASSERT_TRUE(got) << index.transpose();
    EXPECT_TRUE(areSameBlocks(*got, block, 3));
  }
  EXPECT_FALSE(store.get({7, 77, 777}));
}

/** \brief Writes an archive with two frames and closes it. */
inline void
writeArchive(const std::string& path, const Blocks& blocks)
{
  const auto archive = MapArchive::create(path, makeArchiveHeader());
  putAll(blocks, *archive);
  archive->putFrame(3, {1, 2, 3});
  archive->putFrame(7, {});
  ArchiveState state;
  state.cloud_origin = {1000, -2000, 0};
  state.finished = true;
  archive->commit(state);
  archive->close();
}

/** \brief EXPECTs the contents of writeArchive(). */
inline void
expectWritten(const MapArchive& archive, const Blocks& blocks)
{
  expectHolds(archive, blocks);
  EXPECT_EQ(archive.header().configuration, makeArchiveHeader().configuration);
  EXPECT_EQ(archive.header().parameters.voxel_size, 0.25);
  const LabelSet& label_set = archive.header().label_set;
  ASSERT_EQ(label_set.size(), 3);
  EXPECT_EQ(label_set[2].name, "car");
  EXPECT_TRUE(label_set[2].dynamic && label_set[3].sky && !label_set[1].sky);
  EXPECT_EQ(label_set[1].colour[1], 64);
  const ArchiveState state = archive.state();
  EXPECT_EQ(state.cloud_origin, Eigen::Vector3d(1000, -2000, 0));
  EXPECT_TRUE(state.finished);
  EXPECT_EQ(state.blocks, blocks.size());
  EXPECT_EQ(state.frames, 2u);
  EXPECT_EQ(state.last_frame, 7);
  std::map<int, std::vector<std::uint8_t>> frames;
  archive.forEachFrame([&](int number, const std::vector<std::uint8_t>& bytes) {
    frames[number] = bytes;
  });
  EXPECT_EQ(frames, (decltype(frames){{3, {1, 2, 3}}, {7, {}}}));
}

inline Blocks
readBlocks(const std::string& path)
{
  Blocks blocks;
  MapArchive(path, ArchiveAccess::read)
      .forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
        blocks[index] = block;
      });
  return blocks;
}

} // namespace pcl_semantic
