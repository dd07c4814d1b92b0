// SPDX-License-Identifier: BSD-3-Clause
#include "support/archives.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/io/archive_merge.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

namespace pcl_semantic {

namespace {

namespace fs = std::filesystem;

const Eigen::Isometry3d still = Eigen::Isometry3d::Identity();

// Two maps that overlap, over several tiles, and the map in tiles that is made of them.
class MapInTiles : public testing::Test {
protected:
  void
  SetUp() override
  {
    for (int map = 0; map < 2; ++map) {
      Blocks blocks;
      for (int i = -40; i < 40; i += 3)
        blocks[VoxelIndex(i + 20 * map, 2 * i, i % 4)] = makeRandomBlock(
            std::size_t(i % 2 ? 0 : 60), 3, unsigned(100 * map + i + 50));
      inputs_.push_back({folder_.path("map" + std::to_string(map)), still});
      ArchiveState state;
      state.cloud_origin = {1000, 0, 0};
      state.finished = true;
      createWith(inputs_.back().path, blocks, makeArchiveHeader(), state);
    }
    mergeArchives(inputs_, whole_);
    fs::create_directories(folder_.path("tiles"));
    std::set<MapTile> tiles;
    for (const PlacedArchive& input : inputs_)
      for (const MapTile& tile : tilesOf(input))
        tiles.insert(tile);
    tiles.insert({100, 100}); // nothing is there
    tiles_.assign(tiles.begin(), tiles.end());
    for (const MapTile& tile : tiles_)
      mergeTile(inputs_, tile, tilePath(index_, tile));
    writeTileIndex(index_, tiles_);
  }

  static Blocks
  blocksOf(const MapReader& archive)
  {
    Blocks blocks;
    archive.forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
      EXPECT_TRUE(blocks.emplace(index, block).second) << "twice";
    });
    return blocks;
  }

  const TemporaryFolder folder_;
  const std::string whole_ = folder_.path("whole"), index_ = folder_.path("map.tiles");
  std::vector<PlacedArchive> inputs_;
  std::vector<MapTile> tiles_;
};

TEST_F(MapInTiles, IsReadAsTheMergedMap)
{
  const std::unique_ptr<MapReader> reader = MapReader::open(index_);
  const MapReader& tiled = *reader;
  const MapArchive whole(whole_, ArchiveAccess::read);
  EXPECT_GE(tiles_.size(), 10u);
  EXPECT_EQ(tiled.path(), index_);
  EXPECT_EQ(tiled.state().blocks, whole.state().blocks);
  EXPECT_EQ(tiled.state().cloud_origin, whole.state().cloud_origin);
  EXPECT_TRUE(tiled.state().finished);
  EXPECT_EQ(tiled.header().parameters.voxel_size, 0.25);
  const Blocks a = blocksOf(tiled), b = blocksOf(whole);
  ASSERT_EQ(a.size(), b.size());
  std::vector<VoxelIndex> indices, asked;
  tiled.forEachIndex([&](const VoxelIndex& index) { indices.push_back(index); });
  EXPECT_EQ(indices.size(), a.size());
  for (const auto& [index, block] : b) {
    ASSERT_TRUE(a.count(index));
    EXPECT_TRUE(areSameBlocks(a.at(index), block, 3));
    EXPECT_TRUE(tiled.contains(index));
    asked.push_back(index);
  }
  asked.emplace_back(3000, 0, 0);
  const auto several = tiled.get(asked);
  for (std::size_t i = 0; i + 1 < several.size(); ++i)
    EXPECT_TRUE(areSameBlocks(*several[i], b.at(asked[i]), 3));
  EXPECT_EQ(several.back(), nullptr);
  EXPECT_FALSE(tiled.contains({3000, 0, 0}));
  EXPECT_TRUE(verifyArchive(index_).empty());
  // But it is no archive.
  for (const ArchiveAccess access : {ArchiveAccess::read, ArchiveAccess::write})
    EXPECT_THROW(MapArchive(index_, access), std::runtime_error);
}

TEST_F(MapInTiles, ATileIsReplaced)
{
  const std::string tile = tilePath(index_, tiles_.front()), whole = bytesOf(tile);
  for (const std::string& damaged : {std::string("damaged"), whole.substr(0, 5000)}) {
    folder_.write(fs::relative(tile, folder_.path("")).string(), damaged);
    mergeTile(inputs_, tiles_.front(), tile);
    EXPECT_EQ(bytesOf(tile), whole);
  }
}

TEST_F(MapInTiles, TheDigestOfAnArchiveIsThatOfItsContent)
{
  const std::string path = inputs_[0].path, copy = folder_.path("copy");
  MapArchive(path, ArchiveAccess::write).close(); // in one file
  fs::copy_file(path, copy);
  EXPECT_EQ(archiveDigest(copy), archiveDigest(path));
  EXPECT_NE(archiveDigest(inputs_[1].path), archiveDigest(path));
  std::vector<VoxelIndex> indices;
  const auto archive = std::make_shared<MapArchive>(copy, ArchiveAccess::write);
  archive->forEachIndex([&](const VoxelIndex& index) { indices.push_back(index); });
  VoxelBlock block = *archive->get(indices.front());
  block.log_odds[0] = block.log_odds[0] == 1 ? 2 : 1;
  archive->put(indices.front(), block);
  archive->commit(archive->state());
  archive->close();
  EXPECT_NE(archiveDigest(copy), archiveDigest(path));
}

TEST_F(MapInTiles, WithoutATileOrWithABadIndexIsRefused)
{
  const auto refusal = [&](const std::string& text) {
    const std::string path = folder_.write("bad.tiles", text);
    return thrownMessage<BadInputException>([&] { MapReader::open(path); });
  };
  for (const auto& [text, says] :
       {std::pair{"pcl_semantic_tiles 7 1 1\n0 0 1 1\n",
                  "line 1: is no index of tiles"},
        {"pcl_semantic_tiles 1 2 1\n0 0 1 1\n",
         "has 1 tiles of 1 blocks, expected 2 of 1"},
        {"pcl_semantic_tiles 1 2 1\n0 0 1 1\n0 1 0 x\n",
         "line 3: expected four numbers"},
        {"pcl_semantic_tiles 1 1 1\n0 0 1 1\n1 1 1 1\n",
         "has 2 tiles of 2 blocks, expected 1 of 1"},
        {"pcl_semantic_tiles 1 2 2\n0 0 1 1\n0 0 1 1\n",
         "has 1 tiles of 2 blocks, expected 2 of 2"},
        {"pcl_semantic_tiles 1 1 5\n0 0 1 1\n",
         "has 1 tiles of 1 blocks, expected 1 of 5"},
        {"pcl_semantic_tiles 1 0 0\n", "has no tiles"},
        {"pcl_semantic_tiles 1 1 1\n77 77 1 1\n", "tiles/77_77.map: "}})
    EXPECT_TRUE(holds(refusal(text), says)) << text;
  const std::unique_ptr<MapReader> tiled = MapReader::open(index_);
  const auto readAll = [&] { tiled->forEach([](const auto&, const auto&) {}); };
  fs::copy_file(tilePath(index_, tiles_[0]), tilePath(index_, tiles_[1]),
                fs::copy_options::overwrite_existing);
  expectBadInput("has other blocks", readAll);
  ASSERT_EQ(verifyArchive(index_).size(), 1u);
  EXPECT_TRUE(holds(verifyArchive(index_)[0], "has other blocks"));
  fs::remove(tilePath(index_, tiles_[1]));
  EXPECT_THROW(readAll(), BadInputException);
  ASSERT_EQ(verifyArchive(index_).size(), 1u);
  EXPECT_TRUE(holds(verifyArchive(index_)[0], "cannot be read"));
}

} // namespace

} // namespace pcl_semantic
