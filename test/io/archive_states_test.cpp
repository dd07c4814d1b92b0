// SPDX-License-Identifier: BSD-3-Clause

// An archive against a map in memory, under random sequences of what can be done with
// both. A seed that fails is in the message.

#include "support/archives.h"

#include <pcl_semantic/core/exceptions.h>

#include <cstdlib>
#include <optional>

namespace pcl_semantic {

namespace {

using Frames = std::map<int, std::vector<std::uint8_t>>;

struct Content {
  Blocks blocks;
  Frames frames;
};

void
expectIs(const MapArchive& archive, const Content& content)
{
  expectHolds(archive, content.blocks);
  std::vector<VoxelIndex> indices;
  archive.forEachIndex([&](const VoxelIndex& index) { indices.push_back(index); });
  ASSERT_EQ(indices.size(), content.blocks.size());
  auto expected = content.blocks.begin();
  for (const VoxelIndex& index : indices)
    EXPECT_EQ(index, (expected++)->first);
  Frames frames;
  archive.forEachFrame(
      [&](int number, const auto& record) { frames[number] = record; });
  EXPECT_EQ(frames, content.frames);
}

class Machine {
public:
  explicit Machine(unsigned seed) : random_(seed)
  {
    archive_ = MapArchive::create(path_, makeArchiveHeader());
  }

  void
  step()
  {
    switch (random_() % 12) {
    case 0:
    case 1:
    case 2:
      put();
      break;
    case 3:
      putFrame();
      break;
    case 4:
    case 5:
      commit();
      break;
    case 6:
      get();
      break;
    case 7:
      expectIs(*archive_, now_);
      break;
    case 8:
      openReader();
      break;
    case 9:
      if (reader_)
        expectIs(*reader_, seen_by_reader_);
      break;
    case 10:
      close();
      break;
    default:
      lose();
    }
  }

  // All committed blocks exist at the end.
  void
  end()
  {
    reader_.reset();
    archive_.reset();
    expectIs(MapArchive(path_, ArchiveAccess::read), committed_);
    EXPECT_TRUE(verifyArchive(path_).empty());
  }

private:
  // Few places, so that blocks are often replaced.
  VoxelIndex
  place()
  {
    const auto coordinate = [&] { return int(random_() % 3) - 1; };
    return {coordinate(), coordinate(), 125000000 * coordinate()};
  }

  void
  put()
  {
    const VoxelIndex index = place();
    const VoxelBlock block = makeRandomBlock(random_() % 4, 3, unsigned(random_()));
    archive_->put(index, block);
    now_.blocks[index] = block;
  }

  void
  putFrame()
  {
    const int number = int(random_() % 5);
    const std::vector<std::uint8_t> record(random_() % 9, std::uint8_t(random_()));
    archive_->putFrame(number, record);
    now_.frames[number] = record;
  }

  void
  commit()
  {
    ArchiveState state;
    state.cloud_origin = Eigen::Vector3d::Random();
    state.finished = random_() % 2 == 0;
    archive_->commit(state);
    committed_ = now_;
    EXPECT_EQ(archive_->state().cloud_origin, state.cloud_origin);
    EXPECT_EQ(archive_->state().finished, state.finished);
    EXPECT_EQ(archive_->state().blocks, now_.blocks.size());
    EXPECT_EQ(archive_->state().frames, now_.frames.size());
  }

  void
  get()
  {
    const VoxelIndex index = place();
    const auto found = now_.blocks.find(index);
    const auto got = archive_->get(index);
    EXPECT_EQ(archive_->contains(index), found != now_.blocks.end());
    ASSERT_EQ(bool(got), found != now_.blocks.end());
    if (got) {
      EXPECT_TRUE(areSameBlocks(*got, found->second, 3));
    }
  }

  // It reads the blocks committed before it was opened, regardless of later commits.
  void
  openReader()
  {
    reader_.emplace(path_, ArchiveAccess::read);
    seen_by_reader_ = committed_;
  }

  // Uncommitted blocks are lost, with or without a message.
  void
  close()
  {
    reader_.reset(); // else it would be waited for
    EXPECT_TRUE(archive_->close());
    EXPECT_THROW(archive_->put({0, 0, 0}, VoxelBlock()), OutputException);
    lose();
  }

  void
  lose()
  {
    reader_.reset();
    archive_.reset();
    archive_ = std::make_shared<MapArchive>(path_, ArchiveAccess::write);
    now_ = committed_;
  }

  const TemporaryFolder folder_{TemporaryFolder::memory()};
  const std::string path_ = folder_.path("map");
  std::mt19937 random_;
  std::shared_ptr<MapArchive> archive_;
  std::optional<MapArchive> reader_;
  Content now_, committed_, seen_by_reader_;
};

} // namespace

// PCL_SEMANTIC_SEQUENCES=3000 takes minutes.
TEST(ArchiveStates, RandomSequencesGiveWhatAMapInMemoryHolds)
{
  const char* const more = std::getenv("PCL_SEMANTIC_SEQUENCES");
  const unsigned sequences = more ? unsigned(std::atoi(more)) : 100;
  for (unsigned seed = 1; seed <= sequences; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Machine machine(seed);
    for (int step = 0; step < 15; ++step)
      machine.step();
    machine.end();
    ASSERT_FALSE(HasFailure());
  }
}

} // namespace pcl_semantic
