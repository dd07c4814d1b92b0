// SPDX-License-Identifier: BSD-3-Clause
#include "support/archives.h"
#include "support/no_waits.h"
#include "support/process_limits.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/input_file.h>

#include <cmath>
#include <thread>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

// Error message for a program that may not write.
std::string
refusalOf(const std::function<void()>& write)
{
  return thrownMessage<OutputException>(write);
}

std::string
refusalOfCreating(const std::string& path)
{
  return refusalOf([&] { MapArchive::create(path, makeArchiveHeader()); });
}

} // namespace

TEST(MapArchive, GivesBackWhatWasPut)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("map");
  const Blocks blocks = makeRandomBlocks(200, 1);
  writeArchive(path, blocks);
  EXPECT_EQ(folder.entries(), 1u) << "an ended archive is one file";

  expectWritten(MapArchive(path, ArchiveAccess::read), blocks);
  EXPECT_TRUE(verifyArchive(path).empty());
}

TEST(MapArchive, ManyClassesAndParametersSurvive)
{
  std::vector<LabelClass> classes(255);
  for (std::size_t i = 0; i < classes.size(); ++i)
    classes[i].name = "class " + std::to_string(i);
  classes[3].dynamic = classes[4].thin = classes[5].dynamic = classes[5].thin = true;
  ArchiveHeader header{LabelSet(classes), {}, {}};
  header.parameters.window = {1.5, 2.5, 3.5};
  header.parameters.max_range = 17.25;
  header.parameters.fusion.hit_probability = 0.71;
  header.parameters.fusion.label_max_ratio = 123.0;
  header.parameters.fusion.pixel_fusion = PixelFusion::product;
  header.parameters.fusion.per_ray_counting = true;
  header.parameters.fusion.free_dynamic = false;
  const TemporaryFolder folder;
  const VoxelBlock full = makeRandomBlock(kBlockVoxels, 255, 3);
  createWith(folder.path("map"), {{VoxelIndex(0, 0, 0), full}}, header);
  const MapArchive archive(folder.path("map"), ArchiveAccess::read);
  EXPECT_TRUE(areSameBlocks(*archive.get({0, 0, 0}), full, 255));
  const MapParameters& read = archive.header().parameters;
  EXPECT_EQ(read.window, header.parameters.window);
  EXPECT_EQ(read.max_range, 17.25);
  EXPECT_EQ(read.fusion.hit_probability, 0.71);
  EXPECT_EQ(read.fusion.label_max_ratio, 123.0);
  EXPECT_EQ(read.fusion.pixel_fusion, PixelFusion::product);
  EXPECT_TRUE(read.fusion.per_ray_counting);
  EXPECT_FALSE(read.fusion.free_dynamic);
  EXPECT_EQ(archive.header().label_set[255].name, "class 254");
}

TEST(MapArchive, WhatWaitsForACommitIsSeenAndLostWithoutOne)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("map");
  Blocks blocks = makeRandomBlocks(60, 2);
  {
    const auto archive = createWith(path, blocks);
    Blocks changed = blocks;
    for (auto& [index, block] : changed)
      if (index.x() % 2 == 0)
        block = makeRandomBlock(20, 3, unsigned(index.y()));
    for (const auto& [index, block] : makeRandomBlocks(30, 3))
      changed[index] = block;
    putAll(changed, *archive);
    expectHolds(*archive, changed);
    archive->putFrame(1, {1});
  }
  EXPECT_EQ(folder.entries(), 1u);
  const MapArchive archive(path, ArchiveAccess::read);
  expectHolds(archive, blocks);
  EXPECT_EQ(archive.state().frames, 0u);
}

// Far more than waits in memory: the open transaction takes it, and it is still one.
TEST(MapArchive, LongTransactionsAreStillOne)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("map");
  const VoxelBlock block = makeRandomBlock(512, 3, 5), other = makeRandomBlock(9, 3, 6);
  constexpr int count = 3000; // of 26 KB
  {
    const auto archive = createWith(path, {{VoxelIndex(0, 0, 0), other}});
    for (int i = 0; i < count; ++i)
      archive->put({i, 0, 0}, block);
    EXPECT_TRUE(areSameBlocks(*archive->get({0, 0, 0}), block, 3));
    const MapArchive reader(path, ArchiveAccess::read);
    EXPECT_TRUE(areSameBlocks(*reader.get({0, 0, 0}), other, 3));
    EXPECT_EQ(reader.state().blocks, 1u);
  }
  const MapArchive archive(path, ArchiveAccess::read);
  expectHolds(archive, {{VoxelIndex(0, 0, 0), other}});
}

TEST(MapArchive, TheSameMapGivesTheSameBytesForAnyNumberOfThreads)
{
  const TemporaryFolder folder;
  Blocks blocks = makeRandomBlocks(100, 7);
  writeArchive(folder.path("a"), blocks);
  // Records in another order: by place, as an archive gives them.
  const Blocks again = readBlocks(folder.path("a"));
  for (const int threads : {1, 2, 7}) {
    setNumberOfThreads(threads);
    const std::string path = folder.path("b" + std::to_string(threads));
    writeArchive(path, again);
    EXPECT_TRUE(bytesOf(path) == bytesOf(folder.path("a"))) << threads;
  }
  setNumberOfThreads(0);
  blocks.begin()->second.log_odds[0] ^= 1;
  writeArchive(folder.path("c"), blocks);
  EXPECT_FALSE(bytesOf(folder.path("c")) == bytesOf(folder.path("a")));
}

TEST(MapArchive, OnlyOneWrites)
{
  const NoWaits no_waits;
  const TemporaryFolder folder;
  const std::string path = folder.path("map");
  const Blocks blocks = makeRandomBlocks(5, 1), more = makeRandomBlocks(9, 2);
  const auto writer = MapArchive::create(path, makeArchiveHeader());
  const auto refuse = [&] {
    EXPECT_EQ(refusalOf([&] { MapArchive(path, ArchiveAccess::write); }),
              path + ": another program is writing it");
  };
  refuse();
  putAll(blocks, *writer);
  refuse();
  writer->commit({});
  refuse(); // no gap between two transactions
  EXPECT_EQ(refusalOfCreating(path), path + ": is there already");
  writer->close();
  EXPECT_TRUE(holds(refusalOf([&] {
                      writer->put({0, 0, 0}, VoxelBlock());
                    }),
                    "open for writing"));

  const auto second = std::make_unique<MapArchive>(path, ArchiveAccess::write);
  putAll(more, *second);
  second->commit({});
  Blocks all = more;
  all.insert(blocks.begin(), blocks.end());
  expectHolds(*second, all);
}

TEST(MapArchive, ReadersSeeTheLastCommitWhileItIsWritten)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("map");
  const auto writer = MapArchive::create(path, makeArchiveHeader());
  Blocks written;
  for (int round = 0; round < 4; ++round) {
    const MapArchive before(path, ArchiveAccess::read);
    const Blocks seen = written;
    const Blocks more = makeRandomBlocks(20, unsigned(round));
    for (const auto& [index, block] : more)
      written[index] = block;
    putAll(more, *writer);
    expectHolds(before, seen);
    expectHolds(MapArchive(path, ArchiveAccess::read), seen);
    writer->commit({});
    expectHolds(before, seen); // opened earlier
    expectHolds(MapArchive(path, ArchiveAccess::read), written);
    EXPECT_TRUE(verifyArchive(path).empty());
  }
}

TEST(MapArchive, FourReadersWhileOneWrites)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("map");
  const auto writer = MapArchive::create(path, makeArchiveHeader());
  const VoxelBlock block = makeRandomBlock(3, 3, 1);
  std::atomic<bool> done{false};
  std::atomic<int> wrong{0}, reads{0};
  std::vector<std::thread> readers;
  for (int i = 0; i < 4; ++i)
    readers.emplace_back([&] {
      while (!done) {
        const MapArchive reader(path, ArchiveAccess::read);
        std::uint64_t count = 0;
        reader.forEach([&](const VoxelIndex&, const VoxelBlock&) { ++count; });
        wrong += count != reader.state().blocks || count % 10 != 0;
        ++reads;
      }
    });
  for (int commit = 0; commit < 60 || reads < 8; ++commit) {
    for (int i = 0; i < 10; ++i)
      writer->put({commit, i, 0}, block);
    writer->commit({});
  }
  done = true;
  for (std::thread& reader : readers)
    reader.join();
  EXPECT_EQ(wrong, 0);
}

TEST(MapArchive, AFullDiskLeavesTheLastCommit)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("map");
  const Blocks blocks = makeRandomBlocks(20, 1);
  const VoxelBlock block = makeRandomBlock(512, 3, 2);
  {
    const auto archive = createWith(path, blocks);
    const FullDisk full(fs::file_size(path) + 400000);
    const std::string message = refusalOf([&] {
      for (int i = 0; i < 100000; ++i) {
        archive->put({i, 1, 1}, block);
        if (i % 20 == 0)
          archive->commit({});
      }
    });
    EXPECT_TRUE(holds(message, path + ": cannot be written"));
    EXPECT_TRUE(holds(message, "disk full"));
    // Half a transaction must not follow.
    EXPECT_TRUE(holds(refusalOf([&] { archive->commit({}); }), "open for writing"));
  }
  EXPECT_TRUE(verifyArchive(path).empty());
  const MapArchive archive(path, ArchiveAccess::read);
  const std::uint64_t kept = archive.state().blocks;
  EXPECT_GE(kept, blocks.size());
  EXPECT_EQ((kept - blocks.size()) % 20, kept == blocks.size() ? 0u : 1u);
  for (const auto& [index, content] : blocks)
    EXPECT_TRUE(areSameBlocks(*archive.get(index), content, 3));

  const FullDisk full(1000);
  EXPECT_TRUE(holds(refusalOfCreating(folder.path("new")),
                    folder.path("new") + ": cannot be written"));
  EXPECT_FALSE(fs::exists(folder.path("new")));
}

TEST(MapArchive, ReadOnlyFolders)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("map");
  const Blocks blocks = makeRandomBlocks(20, 1);
  writeArchive(path, blocks);
  fs::permissions(folder.path(), fs::perms(0555));
  fs::permissions(path, fs::perms(0444));
  {
    const Unprivileged user;
    if (!user.isEffective())
      GTEST_SKIP() << "cannot give up root's rights";
    EXPECT_TRUE(holds(refusalOf([&] { MapArchive(path, ArchiveAccess::write); }),
                      path + ": cannot be written"));
    EXPECT_TRUE(holds(refusalOfCreating(folder.path("new")),
                      folder.path("new") + ": cannot be written"));
    expectHolds(MapArchive(path, ArchiveAccess::read), blocks);
    EXPECT_TRUE(verifyArchive(path).empty());
  }
  fs::permissions(folder.path(), fs::perms(0755));
}

TEST(MapArchive, BlocksThatDoNotFitAreRefused)
{
  const TemporaryFolder folder;
  const auto archive = MapArchive::create(folder.path("map"), makeArchiveHeader());
  archive->put({0, 0, 0}, makeRandomBlock(5, 4, 1)); // of four classes
  EXPECT_THROW(archive->commit({}), InvalidParameterException);
  for (const bool spoil_refined : {false, true}) {
    const auto other = MapArchive::create(
        folder.path(spoil_refined ? "refined" : "measured"), makeArchiveHeader());
    VoxelBlock block = makeRandomBlock(5, 3, 1);
    (spoil_refined ? block.refined : block.measured)[4] = std::nanf("");
    other->put({0, 0, 0}, block);
    EXPECT_THROW(other->commit({}), InvalidParameterException);
  }
}

// A program still reads when the writer ends: the archive then has two files, and
// either one alone is refused.
TEST(MapArchive, AReaderAtTheEndKeepsTwoFiles)
{
  const NoWaits no_waits;
  const TemporaryFolder folder;
  const std::string path = folder.path("map"), copy = folder.path("copy");
  const Blocks blocks = makeRandomBlocks(20, 1);
  {
    const auto writer = MapArchive::create(path, makeArchiveHeader());
    const MapArchive reader(path, ArchiveAccess::read);
    putAll(blocks, *writer);
    writer->commit({});
    EXPECT_FALSE(writer->close());
    expectHolds(reader, {});
  }
  ASSERT_TRUE(fs::exists(path + "-wal"));
  expectHolds(MapArchive(path, ArchiveAccess::read), blocks);
  EXPECT_TRUE(verifyArchive(path).empty());
  fs::copy_file(path, copy);
  for (const ArchiveAccess access : {ArchiveAccess::read, ArchiveAccess::write})
    for (int time = 0; time < 2; ++time) // the first must not hide it from the second
      expectBadInput(copy + ": lacks " + copy + "-wal, which holds the last commits",
                     [&] { MapArchive(copy, access); });
  EXPECT_THROW(verifyArchive(copy), BadInputException);
  fs::copy_file(path + "-wal", copy + "-wal");
  expectHolds(MapArchive(copy, ArchiveAccess::read), blocks);
  EXPECT_TRUE(MapArchive(path, ArchiveAccess::write).close());
  EXPECT_FALSE(fs::exists(path + "-wal"));
  expectHolds(MapArchive(path, ArchiveAccess::read), blocks);
}

// SQLite takes any log of that name for the file's own.
TEST(MapArchive, TheLogOfAnotherArchiveIsRefused)
{
  const NoWaits no_waits;
  const TemporaryFolder folder;
  const std::string killed = folder.path("killed"), whole = folder.path("whole");
  const Blocks blocks = makeRandomBlocks(20, 1);
  EXPECT_TRUE(createWith(whole, blocks)->close());
  {
    const auto writer = createWith(killed, makeRandomBlocks(30, 2));
    fs::copy_file(killed + "-wal", whole + "-wal");
  }
  for (const ArchiveAccess access : {ArchiveAccess::read, ArchiveAccess::write})
    expectBadInput("is complete, but " + whole + "-wal is of another archive",
                   [&] { MapArchive(whole, access); });
  EXPECT_THROW(verifyArchive(whole), BadInputException);
  fs::remove(whole + "-wal");
  expectHolds(MapArchive(whole, ArchiveAccess::read), blocks);
}

// What SQLite takes for a shorter log.
TEST(MapArchive, VerifyingFindsThatTheLogLacksCommits)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("map"), copy = folder.path("copy");
  const auto writer = MapArchive::create(path, makeArchiveHeader());
  std::vector<std::uintmax_t> ends; // of the log after each commit
  for (unsigned commit = 0; commit < 4; ++commit) {
    putAll(makeRandomBlocks(6, commit), *writer);
    writer->commit({});
    ends.push_back(fs::file_size(path + "-wal"));
  }
  const auto faultsWith = [&](std::uintmax_t damaged) {
    fs::copy_file(path, copy, fs::copy_options::overwrite_existing);
    std::string log = bytesOf(path + "-wal");
    log[damaged] = char(log[damaged] ^ 1);
    std::ofstream(copy + "-wal", std::ios::binary) << log;
    fs::remove(copy + "-shm");
    return verifyArchive(copy);
  };
  EXPECT_TRUE(verifyArchive(path).empty());
  for (std::size_t commit = 0; commit < ends.size(); ++commit) {
    const auto faults = faultsWith(ends[commit] - 100); // in its last page
    ASSERT_EQ(faults.size(), 1u) << commit;
    EXPECT_TRUE(holds(faults[0], copy + "-wal lacks " +
                                     std::to_string(ends.size() - commit) + " commit"));
  }
}

// Older programs would take its new blocks for damaged ones.
TEST(MapArchive, AnOlderVersionThatIsWrittenBecomesTheNewest)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("map");
  fs::copy_file(PCL_SEMANTIC_SOURCE_DIR "/test/io/archive_version_2.map", path);
  const auto versionOf = [&] { // a big-endian number in SQLite's header
    return readBytes(path).at(63);
  };
  ASSERT_EQ(versionOf(), 2);
  MapArchive(path, ArchiveAccess::read).objects();
  EXPECT_EQ(versionOf(), 2);
  MapArchive archive(path, ArchiveAccess::write);
  archive.commit(archive.state());
  archive.close();
  EXPECT_EQ(versionOf(), 3);
  EXPECT_TRUE(verifyArchive(path).empty());
}

} // namespace pcl_semantic
