// SPDX-License-Identifier: BSD-3-Clause

// Damaged or foreign files are refused or do no harm.

#include "io/archive_database.h"
#include "io/block_encoding.h"
#include "support/archives.h"
#include "support/mutate.h"
#include "support/run_sql.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>

namespace pcl_semantic {

namespace {

class DamagedArchive : public testing::Test {
protected:
  DamagedArchive() : path_(folder_.path("map")), blocks_(makeSmallBlocks())
  {
    writeArchive(path_, blocks_);
    bytes_ = bytesOf(path_);
  }

  // Few and small, so that every byte can be tried.
  static Blocks
  makeSmallBlocks()
  {
    Blocks blocks;
    for (int i = 0; i < 12; ++i) {
      VoxelBlock block = makeRandomBlock(std::size_t(i) * 3, 3, unsigned(i));
      block.log_odds.fill(StoredLogOdds(i));
      blocks[VoxelIndex(i % 2 ? i : -i, i * 1000, 3 - i)] = block;
    }
    return blocks;
  }

  void
  write(const std::string& bytes)
  {
    folder_.write("map", bytes);
  }

  // Reads everything there is; EXPECTs that it is right.
  void
  readAll() const
  {
    expectWritten(MapArchive(path_, ArchiveAccess::read), blocks_);
  }

  // Whether the damage is noticed; if not, nothing else may have been read.
  bool
  isNoticed() const
  {
    try {
      readAll();
      return false;
    }
    catch (const BadInputException& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.rfind(path_ + ": ", 0), 0u) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      return true;
    }
  }

  bool
  isFoundByVerify() const
  {
    try {
      return !verifyArchive(path_).empty();
    }
    catch (const BadInputException&) {
      return true;
    }
  }

  std::string
  messageOfReading() const
  {
    return thrownMessage<BadInputException>([&] { readAll(); });
  }

  const TemporaryFolder folder_{TemporaryFolder::memory()};
  const std::string path_;
  const Blocks blocks_;
  std::string bytes_;
};

} // namespace

TEST_F(DamagedArchive, EveryByteCounts)
{
  std::mt19937 random(1);
  int noticed = 0, harmless = 0;
  for (std::size_t at = 0; at < bytes_.size(); at += 1 + random() % 25) {
    std::string damaged = bytes_;
    damaged[at] = char(damaged[at] ^ (1 << (random() % 8)));
    write(damaged);
    const bool is_noticed = isNoticed();
    ++(is_noticed ? noticed : harmless);
    EXPECT_TRUE(!is_noticed || isFoundByVerify()) << at;
    ASSERT_FALSE(HasFailure()) << "byte " << at;
  }
  EXPECT_GT(noticed, 500) << "the rest of the pages is empty";
  EXPECT_GT(harmless, 500);
}

TEST_F(DamagedArchive, TruncationsAndGarbagePages)
{
  for (std::size_t size = 0; size < bytes_.size(); size += 509) {
    write(bytes_.substr(0, size));
    EXPECT_TRUE(isNoticed()) << size;
    EXPECT_TRUE(isFoundByVerify()) << size;
  }
  constexpr std::size_t page = 4096;
  std::mt19937 random(2);
  int harmless = 0;
  for (std::size_t at = 0; at < bytes_.size(); at += page / 2) {
    std::string damaged = bytes_;
    for (std::size_t i = at; i < std::min(at + page / 2, bytes_.size()); ++i)
      damaged[i] = char(random());
    write(damaged);
    harmless += !isNoticed();
    ASSERT_FALSE(HasFailure()) << "byte " << at;
  }
  EXPECT_LE(harmless, 6) << "unused halves of pages";
}

TEST_F(DamagedArchive, RowsThatChangePlaces)
{
  struct Case {
    std::string sql, says;
  };
  for (const Case& bad : std::vector<Case>{
           {"UPDATE blocks SET content = (SELECT content FROM blocks WHERE id = 2) "
            "WHERE id = 1",
            "holds the block"},
           {"UPDATE blocks SET id = -1, z = (SELECT z FROM blocks WHERE id = 2), y = "
            "(SELECT y FROM blocks WHERE id = 2) + 1 WHERE id = 1",
            "blocks, expected the 12 blocks of the last commit"},
           {"DELETE FROM blocks WHERE id = 5", "has 11 blocks, expected the 12"},
           {"INSERT INTO blocks SELECT 99, z + 1, y, x, content FROM blocks LIMIT 1",
            "has 13 blocks, expected the 12"},
           {"UPDATE blocks SET x = 9999999999 WHERE id = 1", "has a block at"},
           {"UPDATE frames SET number = 4 WHERE number = 3", "frame 4: holds another"},
           {"DELETE FROM frames WHERE number = 3", "has 1 frames"},
           {"DELETE FROM meta WHERE name = 'state'", "has no 'state'"},
           {"UPDATE meta SET value = (SELECT value FROM meta WHERE name = 'state') "
            "WHERE name = 'parameters'",
            "'parameters': has an entry of another name"},
           {"PRAGMA user_version = 4", "version 4, newer than this program"},
           {"PRAGMA user_version = 1", "version 1, older than this program"},
           {"PRAGMA user_version = 0", "its tables"},
           {"PRAGMA application_id = 7", "is no map archive"},
           {"DROP TABLE frames", "its tables"},
           {"CREATE TRIGGER t AFTER UPDATE ON meta BEGIN DELETE FROM blocks; END",
            "its tables"}}) {
    SCOPED_TRACE(bad.sql);
    write(bytes_);
    EXPECT_EQ(runSql(path_, bad.sql), "");
    EXPECT_TRUE(holds(messageOfReading(), bad.says));
    EXPECT_TRUE(isFoundByVerify());
  }
}

TEST_F(DamagedArchive, TheMessageNamesTheBlock)
{
  const VoxelIndex index = blocks_.begin()->first;
  EXPECT_EQ(runSql(path_, "UPDATE blocks SET content = zeroblob(100) WHERE z = " +
                              std::to_string(index.z()) +
                              " AND y = " + std::to_string(index.y()) +
                              " AND x = " + std::to_string(index.x())),
            "");
  const std::string name = nameOfBlock(index);
  EXPECT_TRUE(holds(messageOfReading(), path_ + ": " + name + ": is damaged"));
  const MapArchive archive(path_, ArchiveAccess::read);
  expectBadInput(name, [&] { archive.get(index); });
  const std::vector<std::string> faults = verifyArchive(path_);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_TRUE(holds(faults[0], name));
}

TEST_F(DamagedArchive, ForeignFiles)
{
  for (const std::string& bytes :
       {std::string(), std::string("hello\n"), std::string(5000, '\0'),
        std::string("SQLite format 3\0", 16),
        "SQLite format 3" + std::string(4081, 'x'),
        bytesOf(PCL_SEMANTIC_SOURCE_DIR "/README.md")}) {
    write(bytes);
    EXPECT_TRUE(isNoticed());
    EXPECT_THROW(MapArchive(path_, ArchiveAccess::write), BadInputException);
    EXPECT_TRUE(bytesOf(path_) == bytes) << "a foreign file stays as it is";
  }
  const auto messageOf = [](const std::string& path) {
    return thrownMessage<BadInputException>(
        [&] { MapArchive(path, ArchiveAccess::read); });
  };
  EXPECT_EQ(messageOf(folder_.path()),
            folder_.path() + ": is a folder, expected a file");
  EXPECT_EQ(messageOf(folder_.path("none")),
            folder_.path("none") + ": cannot be read: No such file or directory");
  // The end of a file of that name that is gone would become part of the new one.
  folder_.write("other-wal", "x");
  expectRefusal<OutputException>("other-wal: belongs to an earlier archive", [&] {
    MapArchive::create(folder_.path("other"), makeArchiveHeader());
  });
}

// Hostile bytes with a valid checksum.
TEST(BlockEncoding, HostileBytesAreRefused)
{
  const VoxelIndex index(1, -2, 3);
  Mutator mutate(3, {std::string(3, '\xFF'), std::string(2, '\0'), "\x7F\x80"});
  int refused = 0;
  for (unsigned round = 0; round < 3000; ++round) {
    const Bytes good = encodeBlock(index, makeRandomBlock(round % 40, 3, round), 3);
    const std::string bad = mutate(std::string(good.begin(), good.end()));
    try {
      const auto block = decodeBlock(Bytes(bad.begin(), bad.end()), index, 3);
      // An accepted block is valid.
      EXPECT_EQ(encodeBlock(index, *block, 3), Bytes(bad.begin(), bad.end()));
    }
    catch (const BadInputException&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
  const Bytes good = encodeBlock(index, makeRandomBlock(9, 3, 1), 3);
  const auto messageOf = [&](const Bytes& bytes, int classes) {
    return thrownMessage<BadInputException>(
        [&] { decodeBlock(bytes, index, classes); });
  };
  EXPECT_TRUE(holds(messageOf(good, 4), "has 3 classes, expected 4"));
  Bytes infinite = good;
  const std::uint8_t minus_infinity[] = {0x00, 0x00, 0x80,
                                         0xFF}; // the last probability
  constexpr std::ptrdiff_t deviations = 9 * 2;  // bytes at the end
  std::copy(std::begin(minus_infinity), std::end(minus_infinity),
            infinite.end() - deviations - 4);
  EXPECT_TRUE(holds(messageOf(infinite, 3), "not finite"));
}

TEST(SealedBytes, BombsAndBareFramesAreRefused)
{
  Sealer sealer;
  const Bytes content(100000, 7);
  const Bytes sealed = sealer.seal(content);
  EXPECT_LT(sealed.size(), 1000u);
  EXPECT_EQ(unseal(sealed.data(), sealed.size(), content.size()), content);
  Bytes longer = sealed;
  longer.push_back(0);
  for (const auto& [size, max_size] : {std::pair(sealed.size(), content.size() - 1),
                                       {sealed.size() - 1, content.size()},
                                       {longer.size(), content.size()}})
    EXPECT_THROW(unseal(longer.data(), size, max_size), BadInputException) << size;
  EXPECT_THROW(unseal(nullptr, 0, 10), BadInputException);
  for (std::size_t at = 0; at < sealed.size(); ++at)
    for (int bit = 0; bit < 8; ++bit) {
      Bytes damaged = sealed;
      damaged[at] = std::uint8_t(damaged[at] ^ (1 << bit));
      try {
        EXPECT_EQ(unseal(damaged.data(), damaged.size(), content.size()), content);
      }
      catch (const BadInputException&) {
      }
    }
}

} // namespace pcl_semantic
