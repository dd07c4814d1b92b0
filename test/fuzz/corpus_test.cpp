// SPDX-License-Identifier: BSD-3-Clause
#include "doors.h"

#include "support/mutate.h"

#include <pcl_semantic/files/input_file.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace pcl_semantic {

namespace {

const std::filesystem::path corpora = PCL_SEMANTIC_SOURCE_DIR "/test/fuzz/corpus";

std::vector<std::string>
corpusOf(const Door& door)
{
  std::vector<std::string> files;
  for (const auto& file : std::filesystem::directory_iterator(corpora / door.name)) {
    const std::vector<std::uint8_t> bytes = readBytes(file.path());
    files.emplace_back(bytes.begin(), bytes.end());
  }
  return files;
}

} // namespace

// Files found by fuzzing, and one of each format.
TEST(Corpus, EachFileIsReadOrRefused)
{
  for (const Door& door : doors()) {
    SCOPED_TRACE(door.name);
    const std::vector<std::string> files = corpusOf(door);
    EXPECT_FALSE(files.empty());
    int read = 0;
    std::string refusals;
    for (const std::string& bytes : files) {
      ASSERT_NO_THROW(tryDoor(door, bytes));
      try {
        door.read(bytes);
        ++read;
      }
      catch (const std::exception& error) {
        refusals += std::string("\n") + error.what();
      }
    }
    EXPECT_GT(read, 0) << "the fuzzer starts from nothing that is taken:" << refusals;
  }
}

TEST(Corpus, EveryFolderHasItsDoor)
{
  for (const auto& folder : std::filesystem::directory_iterator(corpora)) {
    const std::string name = folder.path().filename();
    EXPECT_TRUE(std::any_of(doors().begin(), doors().end(), [&](const Door& door) {
      return door.name == name;
    })) << name;
  }
}

TEST(Corpus, DamagedFilesAreReadOrRefused)
{
  for (const Door& door : doors()) {
    SCOPED_TRACE(door.name);
    Mutator damage(1, {"-1", "4294967296", "nan", "1e999", "\xff", "[", "{", "\t", ""});
    for (const std::string& bytes : corpusOf(door))
      for (int i = 0; i < 20; ++i)
        ASSERT_NO_THROW(tryDoor(door, damage(bytes)));
  }
}

} // namespace pcl_semantic
