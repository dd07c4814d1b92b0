// SPDX-License-Identifier: BSD-3-Clause

// Other SQLite programs (its shell, Python's sqlite3, a viewer) open an archive: they
// bring its log into the file and remove it.

#include "support/archives.h"
#include "support/no_waits.h"
#include "support/run_sql.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

// Their actions before they close the file.
const char* const actions[] = {"SELECT * FROM meta",
                               "PRAGMA wal_checkpoint(TRUNCATE); SELECT * FROM meta",
                               "PRAGMA wal_checkpoint(PASSIVE)",
                               "PRAGMA journal_mode = DELETE",
                               "PRAGMA journal_mode = WAL",
                               "VACUUM"};

std::string
refusalOf(const std::string& path, ArchiveAccess access = ArchiveAccess::read)
{
  return thrownMessage<BadInputException>([&] { MapArchive(path, access); });
}

// The file without its log contains these blocks, or is refused. Returns whether it is
// refused.
bool
isRefusedAlone(const std::string& path, const Blocks& blocks)
{
  const TemporaryFolder alone(TemporaryFolder::memory());
  fs::copy_file(path, alone.path("map"));
  try {
    expectHolds(MapArchive(alone.path("map"), ArchiveAccess::read), blocks);
    return false;
  }
  catch (const BadInputException& error) {
    EXPECT_TRUE(holds(error.what(), "lacks " + alone.path("map-wal"))) << error.what();
    return true;
  }
}

class OtherPrograms : public testing::Test {
protected:
  // Puts some more blocks.
  void
  commitTo(MapArchive& archive, std::size_t count = 5)
  {
    const Blocks more = makeRandomBlocks(count, ++seed_);
    for (const auto& [index, block] : more)
      blocks_[index] = block;
    putAll(more, archive);
    archive.commit({});
  }

  // Copies the files of a killed writer.
  std::string
  killedCopyOf(const std::string& path, const std::string& name)
  {
    for (const char* const ending : {"", "-wal"}) {
      const auto to = folder_.path(name + ending);
      fs::remove(folder_.path(name + "-shm"));
      fs::copy_file(path + ending, to, fs::copy_options::overwrite_existing);
    }
    return folder_.path(name);
  }

  // Reads it and continues it.
  void
  expectWhole(const std::string& path)
  {
    expectHolds(MapArchive(path, ArchiveAccess::read), blocks_);
    EXPECT_TRUE(verifyArchive(path).empty());
    const Blocks before = blocks_;
    {
      MapArchive archive(path, ArchiveAccess::write);
      commitTo(archive);
      EXPECT_TRUE(isRefusedAlone(path, blocks_));
      EXPECT_TRUE(archive.close());
    }
    EXPECT_FALSE(fs::exists(path + "-wal"));
    EXPECT_FALSE(isRefusedAlone(path, blocks_));
    EXPECT_TRUE(verifyArchive(path).empty());
    blocks_ = before;
  }

  const NoWaits no_waits_;
  const TemporaryFolder folder_{TemporaryFolder::memory()};
  const std::string path_ = folder_.path("map");
  Blocks blocks_;
  unsigned seed_ = 0;
};

} // namespace

TEST_F(OtherPrograms, NothingIsLackingAfterAFinishedRun)
{
  commitTo(*MapArchive::create(path_, makeArchiveHeader()));
  for (const std::string action : actions) {
    SCOPED_TRACE(action);
    const std::string copy = folder_.path("copy");
    fs::remove(copy);
    fs::copy_file(path_, copy);
    EXPECT_EQ(runSql(copy, action), "");
    EXPECT_FALSE(isRefusedAlone(copy, blocks_));
    expectWhole(copy);
  }
}

TEST_F(OtherPrograms, NothingIsLackingAfterAKilledRun)
{
  const auto writer = MapArchive::create(path_, makeArchiveHeader());
  const auto tryAll = [&] {
    EXPECT_TRUE(isRefusedAlone(path_, blocks_));
    for (const std::string action : actions) {
      SCOPED_TRACE(action);
      const std::string killed = killedCopyOf(path_, "killed");
      expectHolds(MapArchive(killed, ArchiveAccess::read), blocks_);
      EXPECT_EQ(runSql(killed, action), "");
      EXPECT_FALSE(fs::exists(killed + "-wal"));
      EXPECT_FALSE(isRefusedAlone(killed, blocks_));
      expectWhole(killed);
    }
  };
  commitTo(*writer);
  tryAll();
  // Enough to merge the log into the file and restart it.
  const std::uintmax_t size = fs::file_size(path_);
  while (fs::file_size(path_) == size)
    commitTo(*writer, 30);
  tryAll();
  commitTo(*writer);
  tryAll();
}

// A kill is over, but a reader of ours is still there.
TEST_F(OtherPrograms, AReaderKeepsTheLog)
{
  const auto writer = MapArchive::create(path_, makeArchiveHeader());
  commitTo(*writer);
  for (const std::string action : actions) {
    SCOPED_TRACE(action);
    const std::string killed = killedCopyOf(path_, "killed");
    {
      const MapArchive reader(killed, ArchiveAccess::read);
      runSql(killed, action); // may find it locked
      expectHolds(reader, blocks_);
      isRefusedAlone(killed, blocks_);
      expectHolds(MapArchive(killed, ArchiveAccess::read), blocks_);
    }
    expectWhole(killed);
  }
}

TEST_F(OtherPrograms, DuringARunTheNextCommitIsNotLost)
{
  const auto writer = MapArchive::create(path_, makeArchiveHeader());
  for (const std::string action : actions) {
    SCOPED_TRACE(action);
    commitTo(*writer);
    const Blocks before = blocks_;
    const MapArchive reader(path_, ArchiveAccess::read);
    EXPECT_TRUE(isRefusedAlone(path_, blocks_));
    runSql(path_, action);
    isRefusedAlone(path_, blocks_);
    commitTo(*writer);
    EXPECT_TRUE(isRefusedAlone(path_, blocks_));
    runSql(path_, action); // the reader is in the way of the newest
    commitTo(*writer);
    EXPECT_TRUE(isRefusedAlone(path_, blocks_));
    expectHolds(reader, before);
    expectHolds(MapArchive(path_, ArchiveAccess::read), blocks_);
    EXPECT_TRUE(verifyArchive(path_).empty());
  }
  EXPECT_TRUE(writer->close());
  expectWhole(path_);
}

// FILE and the log said the same, so another program must not have come in between.
TEST_F(OtherPrograms, AnOlderArchiveGoesOnWithItsLog)
{
  const auto marked = [](std::uint32_t mark) {
    return "PRAGMA application_id = " + std::to_string(mark) + "; ";
  };
  const std::uint32_t whole = 0x50434C53, with_log = 0x50434C57;
  commitTo(*MapArchive::create(path_, makeArchiveHeader()));
  sqlite3* older = nullptr;
  ASSERT_EQ(sqlite3_open(path_.c_str(), &older), SQLITE_OK);
  const auto run = [&](const std::string& sql) {
    EXPECT_EQ(sqlite3_exec(older, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
  };
  run("PRAGMA journal_mode = WAL; CREATE TEMP TABLE saved AS SELECT * FROM blocks; "
      "DELETE FROM blocks; " +
      marked(with_log) + "PRAGMA wal_checkpoint(FULL)");
  run("INSERT INTO blocks SELECT * FROM saved");
  for (const std::string& last : {std::string(), marked(whole)}) { // at its end
    run(last);
    const std::string killed = killedCopyOf(path_, "killed");
    EXPECT_TRUE(isRefusedAlone(killed, blocks_));
    expectHolds(MapArchive(killed, ArchiveAccess::read), blocks_);
    expectWhole(killed);
  }
  sqlite3_close(older);
}

// Beside a file that has a log of its own, too: it would be read as part of it.
TEST_F(OtherPrograms, TheLogOfAnotherKilledRunIsRefused)
{
  const auto writer = MapArchive::create(path_, makeArchiveHeader());
  const auto other = MapArchive::create(folder_.path("other"), makeArchiveHeader());
  commitTo(*writer);
  other->commit({});
  const std::string mixed = killedCopyOf(path_, "mixed");
  fs::copy_file(folder_.path("other-wal"), mixed + "-wal",
                fs::copy_options::overwrite_existing);
  for (const ArchiveAccess access : {ArchiveAccess::read, ArchiveAccess::write})
    EXPECT_TRUE(
        holds(refusalOf(mixed, access), "got " + mixed + "-wal of another archive"));
}

TEST_F(OtherPrograms, ALogWithNothingInItIsRefusedButForAnEmptyOne)
{
  const auto writer = MapArchive::create(path_, makeArchiveHeader());
  commitTo(*writer);
  const std::string damaged = killedCopyOf(path_, "damaged");
  std::string log = bytesOf(damaged + "-wal");
  log[17] = char(log[17] ^ 1); // of its header
  folder_.write("damaged-wal", log);
  EXPECT_TRUE(holds(refusalOf(damaged), damaged + "-wal is damaged"));
  folder_.write("damaged-wal", "");
  fs::remove(damaged + "-shm");
  EXPECT_EQ(MapArchive(damaged, ArchiveAccess::read).state().blocks, 0u);
  MapArchive(damaged, ArchiveAccess::write).close();
  EXPECT_EQ(MapArchive(damaged, ArchiveAccess::read).state().blocks, 0u);
}

} // namespace pcl_semantic
