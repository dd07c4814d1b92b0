// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/random_blocks.h"
#include "support/temporary_folder.h"

#include <pcl_semantic/io/map_archive.h>

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace pcl_semantic {

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

/** \brief EXPECTs that forEach gives exactly these, in order, and get the same. */
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

/** \brief Writes an archive with two frames and ends it. */
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

/** \brief EXPECTs all that writeArchive() wrote. */
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

/** \brief The blocks of an archive. */
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
