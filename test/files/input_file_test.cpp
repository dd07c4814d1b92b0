// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/data_folder.h>
#include <pcl_semantic/files/input_file.h>

#include <gtest/gtest.h>

#include <unistd.h>

using namespace pcl_semantic;

TEST(ReadBytes, GivesTheBytes)
{
  const TemporaryFolder folder;
  const std::string bytes("a\0\r\n\xFF", 5);
  const auto read = readBytes(folder.write("a.bin", bytes));
  EXPECT_EQ(std::string(read.begin(), read.end()), bytes);
  EXPECT_TRUE(readBytes(folder.write("empty", "")).empty());
}

TEST(ReadBytes, RefusesWhatIsNoFile)
{
  const TemporaryFolder folder;
  int pipe[2];
  ASSERT_EQ(::pipe(pipe), 0);
  for (const std::string& path :
       {folder.path(), folder.path("missing"), folder.path(std::string(300, 'x')),
        "/proc/self/fd/" + std::to_string(pipe[0])})
    expectBadInput(path, [&] { readBytes(path); });
  ::close(pipe[0]);
  ::close(pipe[1]);
}

TEST(ReadLines, AcceptsEveryEditor)
{
  const TemporaryFolder folder;
  const auto lines = readLines(folder.write("a.txt", "\xEF\xBB\xBF"
                                                     "one\r\n\r\n  two \t\r\nthree"));
  const char* const expected[] = {"one", "", "  two", "three"};
  ASSERT_EQ(lines.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(lines[i].text, expected[i]);
  EXPECT_EQ(lines[3].number, 4);
  EXPECT_TRUE(readLines(folder.write("empty", "")).empty());
}

TEST(ParseNumber, TakesTheWholeTextOrNothing)
{
  EXPECT_EQ(parseNumber("-1.5e3", "here"), -1500.0);
  EXPECT_EQ(parseNumber("+7", "here"), 7.0);
  for (const char* const text :
       {"", "+", "-", "+-7", "++7", "1,5", "1.5m", " 1", "0x10"})
    EXPECT_TRUE(throws<BadInputException>("f.txt line 3", [&] {
      parseNumber(text, "f.txt line 3");
    })) << text;
}

TEST(ParseNumbers, AreFinite)
{
  EXPECT_EQ(parseNumbers(" 1 2\t-3.5e-2 ", "here"),
            (std::vector<double>{1.0, 2.0, -0.035}));
  EXPECT_TRUE(parseNumbers("", "here").empty());
  for (const char* const text : {"1 nan", "inf", "1 -inf 2", "1e999"})
    thrownMessage<BadInputException>([&] { parseNumbers(text, "here"); });
}

TEST(ListFrameFiles, AreInTheOrderOfTheirNumbers)
{
  const TemporaryFolder folder;
  for (const char* const name : {"000010.png", "2.png", "000003.bin", "000004.jpg",
                                 "a.png", "-1.png", "5a.png", "notes.txt"})
    folder.write(name, "");
  const auto files = listFrameFiles(folder.path(), {".png", ".bin"});
  ASSERT_EQ(files.size(), 3u);
  EXPECT_EQ(files[0].frame, 2);
  EXPECT_EQ(files[1].frame, 3);
  EXPECT_EQ(files[2].frame, 10);
  EXPECT_EQ(files[2].path, folder.path("000010.png"));
  folder.write("000003.png", ""); // twice
  expectBadInput("frame 3", [&] { listFrameFiles(folder.path(), {".png", ".bin"}); });
  EXPECT_EQ(listFrameFiles(folder.path(), {".png"}).size(), 3u);
  thrownMessage<BadInputException>([&] { listFrameFiles(folder.path("none"), {}); });
}

TEST(ListFrameFiles, RefusesDatesAndTimeStamps)
{
  for (const std::string name :
       {"1000000.png", "20230115.png", "2147483647.png", "1403636579763555584.png"}) {
    const TemporaryFolder folder;
    folder.write("000003.png", "");
    folder.write(name, "");
    expectBadInput(name + ": is no frame number, expected 0 to 999999",
                   [&] { listFrameFiles(folder.path(), {".png"}); });
    EXPECT_TRUE(listFrameFiles(folder.path(), {".bin"}).empty());
  }
}

TEST(FrameFileName, HasSixDigits)
{
  EXPECT_EQ(frameFileName(12, ".png"), "000012.png");
  EXPECT_EQ(frameFileName(1234567, ".bin"), "1234567.bin");
}

// That an installed library finds its data is checked by test/downstream.
TEST(FindDataFile, IsThatOfTheSourcesInABuild)
{
  for (const char* name : {"label_sets/kitti11.yaml", "presets/paper.yaml"})
    EXPECT_TRUE(std::filesystem::equivalent(
        findDataFile(name), std::string(PCL_SEMANTIC_SOURCE_DIR "/data/") + name));
  expectBadInput("label_sets/none.yaml: is not among the data of this installation",
                 [] { findDataFile("label_sets/none.yaml"); });
}
