// SPDX-License-Identifier: BSD-3-Clause
#include "files/file_pattern.h"
#include "support/process_limits.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <gtest/gtest.h>

#include <fcntl.h>

namespace pcl_semantic {

TEST(FilePattern, FindsFilesInNaturalOrder)
{
  const TemporaryFolder folder;
  for (const char* const name : {"a10.png", "a2.png", "a1.png", "b3.png", "a3.jpg"})
    folder.write(name, "");
  const auto names = [&](const std::string& pattern) {
    std::vector<std::string> files = findFiles(folder.path(pattern), {".png", ".jpg"});
    for (std::string& file : files)
      file = file.substr(folder.path().size() + 1);
    return files;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(names("*.png"), (Names{"a1.png", "a2.png", "a10.png", "b3.png"}));
  EXPECT_EQ(names("a?.png"), (Names{"a1.png", "a2.png"}));
  EXPECT_EQ(names("[ab][23].*"), (Names{"a2.png", "a3.jpg", "b3.png"}));
  EXPECT_EQ(names("b3.png"), Names{"b3.png"});
  EXPECT_EQ(names("."),
            (Names{"./a1.png", "./a2.png", "./a3.jpg", "./a10.png", "./b3.png"}));
  folder.write("b3.JPG", "");
  expectBadInput("select one by a pattern", [&] { names("."); });
  expectBadInput("*.bmp: no file matches", [&] { names("*.bmp"); });
  expectBadInput("none/*.png: no file matches", [&] { names("none/*.png"); });
}

TEST(FilePattern, AFolderThatCannotBeReadIsSaid)
{
  const TemporaryFolder folder; // of its owner alone
  const std::string pattern = folder.path("*.png");
  const Unprivileged user;
  if (!user.isEffective() ||
      ::faccessat(AT_FDCWD, folder.path().c_str(), R_OK, AT_EACCESS) == 0)
    GTEST_SKIP() << "skipped: this user reads everything";
  expectBadInput("*.png: a folder cannot be read",
                 [&] { findFiles(pattern, {".png"}); });
}

TEST(FilePattern, NaturalOrderIsAnOrder)
{
  const std::vector<std::string> sorted = {
      "",    "01", "1",     "2",    "010",   "10",  "99999999999999999999",
      "a",   "a1", "a1b02", "a1b2", "a1b10", "a02", "a2b",
      "a10", "b",  "ba"};
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    EXPECT_FALSE(naturalLess(sorted[i], sorted[i]));
    for (std::size_t j = i + 1; j < sorted.size(); ++j) {
      const std::string &a = sorted[i], &b = sorted[j];
      EXPECT_TRUE(naturalLess(a, b)) << a << " " << b;
      EXPECT_FALSE(naturalLess(b, a)) << a << " " << b;
    }
  }
}

TEST(FilePattern, NumbersInAName)
{
  using Numbers = std::vector<std::string>;
  EXPECT_EQ(numbersIn("left/cam0_00120.png"), (Numbers{"0", "120"}));
  EXPECT_EQ(numbersIn("000"), Numbers{"0"});
  EXPECT_EQ(numbersIn("1403636579763555584.png"), Numbers{"1403636579763555584"});
  EXPECT_EQ(numbersIn("a.png"), Numbers{});
}

TEST(FrameNumbersOf, AreNamesThatAreNumbers)
{
  EXPECT_EQ(frameNumbersOf({"a/2.pcd", "a/000010.pcd", "999999.pcd"}),
            (std::vector<int>{2, 10, 999999}));
  for (const char* const other :
       {"20230115.pcd", "1000000.pcd", "a1.pcd", "-1.pcd", "1.5.pcd", ".pcd"})
    EXPECT_TRUE(frameNumbersOf({"1.pcd", other}).empty()) << other;
  expectBadInput("1.pcd and 01.pcd: are both frame 1", [] {
    frameNumbersOf({"1.pcd", "01.pcd"});
  });
  expectBadInput("04.pcd and 4.pcd: are both frame 4", [] {
    frameNumbersOf({"1.pcd", "2.pcd", "04.pcd", "4.pcd", "5.pcd"});
  });
}

} // namespace pcl_semantic
