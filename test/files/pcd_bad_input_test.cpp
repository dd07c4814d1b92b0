// SPDX-License-Identifier: BSD-3-Clause

// Files that PCL's reader crashes on, over-reads, or takes for good.

#include "files/pcd_file.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>

#include <gtest/gtest.h>

using namespace pcl_semantic;

namespace {

// A whole file, line by line, so that a test can spoil one.
struct Lines {
  std::string fields = "FIELDS x y label\n";
  std::string size = "SIZE 4 8 2\n";
  std::string type = "TYPE F F U\n";
  std::string count = "COUNT 1 1 1\n";
  std::string width = "WIDTH 2\n";
  std::string height = "HEIGHT 2\n";
  std::string viewpoint = "VIEWPOINT 0 0 0 1 0 0 0\n";
  std::string points = "POINTS 4\n";
  std::string data = "DATA ascii\n";
  std::string content = "1 2 3\n4 5 6\n7 8 9\n10 11 12\n";

  std::string
  text() const
  {
    return "VERSION 0.7\n" + fields + size + type + count + width + height + viewpoint +
           points + data + content;
  }
};

// The message about a file, which has to name it.
std::string
refusal(const std::string& bytes)
{
  const TemporaryFolder folder;
  const std::string path = folder.write("cloud.pcd", bytes);
  const std::string message = thrownMessage<BadInputException>([&] { readPcd(path); });
  EXPECT_TRUE(holds(message, path));
  EXPECT_LT(message.size(), path.size() + 250u);
  for (const char c : message)
    EXPECT_TRUE(c >= ' ' && c <= '~') << int(c);
  return message;
}

::testing::AssertionResult
refuses(std::string Lines::*line, const std::string& spoilt, const std::string& part)
{
  Lines lines;
  lines.*line = spoilt;
  return holds(refusal(lines.text()), part);
}

Lines
binaryLines()
{
  Lines lines;
  lines.data = "DATA binary\n";
  lines.content = std::string(4 * 14, 'a');
  return lines;
}

// Little-endian.
std::string
fourBytes(std::uint32_t value)
{
  std::string bytes;
  for (int i = 0; i < 4; ++i)
    bytes += char(value >> (8 * i) & 0xFF);
  return bytes;
}

// 56 bytes in two runs of literals.
const std::string literals =
    char(31) + std::string(32, 'a') + char(23) + std::string(24, 'b');

Lines
compressedLines(std::uint32_t unpacked = 56, const std::string& packed = literals)
{
  Lines lines;
  lines.data = "DATA binary_compressed\n";
  lines.content =
      fourBytes(std::uint32_t(packed.size())) + fourBytes(unpacked) + packed;
  return lines;
}

} // namespace

TEST(BadPcd, TheFilesAreGoodUnlessSpoilt)
{
  const TemporaryFolder folder;
  for (const Lines& lines : {Lines(), binaryLines(), compressedLines()})
    EXPECT_EQ(readPcd(folder.write("a.pcd", lines.text())).data.size(), 56u);
}

TEST(BadPcd, NoPcd)
{
  EXPECT_TRUE(holds(refusal(""), "empty"));
  EXPECT_TRUE(holds(refusal("\n\n# only a comment"), "ends without DATA"));
  EXPECT_TRUE(holds(refusal("\x89PNG\r\n\x1A\n garbage"), "line 1: '?PNG'"));
  std::string random;
  for (int i = 0; i < 5000; ++i)
    random += char(i * i * 2654435761u >> 7);
  refusal(random);
  refusal(std::string(100000, 'x'));
  refusal(std::string(100000, '\0'));
  const TemporaryFolder folder;
  thrownMessage<BadInputException>([&] { readPcd(folder.path()); });
  expectBadInput("no.pcd", [&] { readPcd(folder.path("no.pcd")); });
}

TEST(BadPcd, AHeaderThatSaysSomethingElse)
{
  using Words = std::vector<std::string>;
  struct Case {
    std::string Lines::*line;
    std::string part;
    Words spoilt;
  };
  for (const Case& each : std::vector<Case>{
           {&Lines::fields, "has no FIELDS", {""}},
           {&Lines::size, "has no SIZE", {""}},
           {&Lines::type, "has no TYPE", {""}},
           {&Lines::width, "has no WIDTH", {""}},
           {&Lines::height, "has no HEIGHT", {""}},
           {&Lines::fields, "line 2: FIELDS names none", {"FIELDS"}},
           {&Lines::fields, "'x' for the second", {"FIELDS x y x"}},
           {&Lines::fields, "padding", {"FIELDS _ _ _"}},
           {&Lines::fields, "line 3: SIZE has 3 value(s), expected 2", {"FIELDS x y"}},
           {&Lines::fields, "field '?'", {"FIELDS x y \x01"}},
           {&Lines::size, "of 2 bytes", {"SIZE 4 2 2"}},
           {&Lines::size,
            "line",
            {"SIZE 3 8 2", "SIZE 16 8 2", "SIZE 0 8 2", "SIZE -4 8 2", "SIZE 4.0 8 2",
             "SIZE x 8 2", "SIZE 99999999999999999999 8 2"}},
           {&Lines::type, "line 4: TYPE has 4", {"TYPE F F U U"}},
           {&Lines::type,
            "line 4: TYPE",
            {"TYPE f F U", "TYPE X F U", "TYPE FF F U", "TYPE B F U"}},
           {&Lines::count, "line 5: 'COUNTS'", {"COUNTS 1 1 1"}},
           {&Lines::width, "line 7: WIDTH for the second time", {"WIDTH 2\nWIDTH 2"}},
           {&Lines::width, "line 9: POINTS is '4'", {"WIDTH 3"}},
           {&Lines::width,
            "line 6",
            {"WIDTH -2", "WIDTH 4000000000000", "WIDTH 2.0", "WIDTH ", "WIDTH 2 2",
             "WIDTH 0x2"}},
           {&Lines::viewpoint,
            "line 8: VIEWPOINT",
            {"VIEWPOINT 0 0 0 1 0 0", "VIEWPOINT 0 0 0 1 0 0 0 0",
             "VIEWPOINT 0 0 0 1 0 0 nan", "VIEWPOINT 0 0 inf 1 0 0 0",
             "VIEWPOINT 0 0 0 1,0 0 0 0", "VIEWPOINT 0 0 0 1e999 0 0 0"}},
           {&Lines::points, "which is 4", {"POINTS 5"}},
           {&Lines::points, "", {"POINTS 18446744073709551620"}}, // 4 in 64 bits
           {&Lines::data, "DATA has 0 value(s)", {"DATA"}},
           {&Lines::data, "line 11: '1'", {""}},
           {&Lines::data, "line 10: DATA is 'Ascii'", {"DATA Ascii"}},
           {&Lines::data, "line 10: DATA has", {"DATA ascii binary"}},
           // PCL continues to read its header after DATA.
           {&Lines::content,
            "line 11: 'FIELDS' is not a number",
            {"FIELDS x\n1 2 3\n4 5 6\n7 8 9\n1 2 3"}}})
    for (const std::string& spoilt : each.spoilt)
      EXPECT_TRUE(refuses(each.line, spoilt + "\n", each.part)) << spoilt;
  for (const std::string& count : Words{"-1", "0", "1000000000", "65537", "1e3", "nan"})
    EXPECT_TRUE(refuses(&Lines::count, "COUNT 1 " + count + " 1\n",
                        "line 5: COUNT is '" + count));
  std::string text = Lines().text();
  EXPECT_TRUE(holds(refusal(text.replace(8, 3, "0.8")), "line 1: VERSION is '0.8'"));
  Lines lines;
  lines.content.clear();
  lines.data.clear();
  EXPECT_TRUE(holds(refusal(lines.text()), "ends without DATA"));
  lines = Lines();
  lines.size = "SIZE 8 8 2\n";
  lines.count = "COUNT 65536 65536 65536\n";
  EXPECT_TRUE(holds(refusal(lines.text()), "points of 1179648 bytes"));
}

TEST(BadPcd, APointCountBeyondTheFile)
{
  // The product of the first pair is 0 in 32 bits, which crashes PCL.
  for (const auto& [width, height, points] :
       {std::tuple("65536", "65536", "0"), std::tuple("65536", "65536", "4294967296"),
        std::tuple("4000000000", "1", "4000000000"),
        std::tuple("4294967295", "4294967295", "18446744065119617025")})
    for (Lines lines : {Lines(), binaryLines(), compressedLines()}) {
      lines.width = "WIDTH " + std::string(width) + "\n";
      lines.height = "HEIGHT " + std::string(height) + "\n";
      lines.points = "POINTS " + std::string(points) + "\n";
      refusal(lines.text());
    }
}

TEST(BadPcd, AsciiLinesTooShortTooLongOrTooMany)
{
  for (const auto& [content, part] :
       {std::pair("1 2 3\n4 5\n7 8 9\n10 11 12\n",
                  "line 12: has 2 number(s), expected 3"),
        std::pair("1 2 3\n4 5 6 7\n7 8 9\n10 11 12\n", "line 12: has more than 3"),
        std::pair("1 2 3\n4 5 6\n7 8 9\n", "has 3 points, expected 4"),
        std::pair("1 2 3\n4 5 6\n7 8 9\n1 2 3\n1 2 3\n", "line 15: "),
        std::pair("", "has 0 points"),
        // Two lines that together have the right number of values.
        std::pair("1 2\n3 4 5 6\n7 8 9\n10 11 12\n", "line 11")})
    EXPECT_TRUE(refuses(&Lines::content, content, part));
}

TEST(BadPcd, AsciiWordsThatAreNoNumberOfTheirType)
{
  const auto refuses_point = [](const std::string& point, const std::string& part) {
    return refuses(&Lines::content, "1 2 3\n" + point + "\n7 8 9\n10 11 12\n", part);
  };
  for (const char* const point :
       {"abc 5 6", "1,5 5 6", "4x 5 6", "0x10 5 6", "4 5 nan", "4 5 6.5", "4 5 -1",
        "4 5 65536", "1e39 5 6", "-1e39 5 6", "4 1e309 6", "+-4 5 6", "+ 5 6", "4. . 6",
        "# 5 6", "4\v5 5 6"})
    EXPECT_TRUE(refuses_point(point, "line 12: '")) << point;
  EXPECT_TRUE(refuses_point("1e39 5 6", "too large"));
  EXPECT_TRUE(refuses_point("4 5 6.5", "field 'label', type U of 2 bytes"));
  EXPECT_TRUE(refuses_point(std::string(100000, '9') + " 5 6", "line 12"));
  EXPECT_TRUE(refuses_point(std::string("4\0 5 6", 7), "line 12: '4?'"));
}

TEST(BadPcd, BinaryDataTooShortOrTooLong)
{
  Lines behind = binaryLines();
  behind.content = "FIELDS x\nCOUNT 9\n" + behind.content;
  refusal(behind.text());
  for (const std::size_t bytes : {0u, 1u, 55u}) {
    Lines lines = binaryLines();
    lines.content.resize(bytes);
    EXPECT_TRUE(holds(refusal(lines.text()), "expected 4 points of 14 bytes"));
  }
  Lines lines = binaryLines();
  lines.content += "x";
  EXPECT_TRUE(holds(refusal(lines.text()), "1 bytes behind the data"));
  lines.content = binaryLines().content + std::string(65537, '\0');
  EXPECT_TRUE(holds(refusal(lines.text()), "behind the data"));
}

TEST(BadPcd, CompressedDataThatLie)
{
  // PCL believes the size and returns what happens to be in memory.
  EXPECT_TRUE(holds(refusal(compressedLines(40).text()), "40 bytes long, expected 56"));
  refusal(compressedLines(57).text());
  refusal(compressedLines(0xFFFFFFFFu).text());
  refusal(compressedLines(0).text());
  Lines lines = compressedLines();
  for (const std::size_t bytes : {0u, 7u, 8u, 20u, 65u}) {
    lines.content.resize(bytes);
    refusal(lines.text());
  }
  lines = compressedLines();
  lines.content.replace(0, 4, fourBytes(0xFFFFFFF0u));
  refusal(lines.text());
  lines = compressedLines();
  lines.content += "x";
  EXPECT_TRUE(holds(refusal(lines.text()), "behind the data"));
}

TEST(BadPcd, CompressedDataThatAreDamaged)
{
  const std::string start = literals.substr(0, 33);
  for (const std::string& packed :
       {start + char(24) + std::string(24, 'b'),        // a literal is cut off
        start + char(23) + std::string(23, 'b') + "bb", // and ends too late
        start,                                          // too few bytes
        literals + char(0) + "x",                       // too many
        start + "\xE0",                                 // a long repetition is cut off
        start + "\xE0\x10",                             // so is this one
        start + "\x20",                                 // a short one
        start + std::string("\xE0\x0F\x20", 3),         // from before the beginning
        start + std::string("\xE0\x10\x00", 3)})        // one byte too long
    EXPECT_TRUE(holds(refusal(compressedLines(56, packed).text()), "damaged"));
  // The last one, right: 7 + 15 + 2 repetitions of the byte before.
  const TemporaryFolder folder;
  const PcdTable table = readPcd(folder.write(
      "a.pcd", compressedLines(56, start + std::string("\xE0\x0F\x00", 3)).text()));
  EXPECT_EQ(table.data, std::vector<std::uint8_t>(56, 'a'));
}

TEST(BadPcd, AHeaderOfAMillionFieldsEnds)
{
  std::string fields = "FIELDS", sizes = "SIZE", types = "TYPE";
  for (int i = 0; i < 300000; ++i) {
    fields += " _";
    sizes += " 1";
    types += " U";
  }
  const TemporaryFolder folder;
  const std::string bytes = fields + " x\n" + sizes + " 4\n" + types +
                            " F\nWIDTH 1\nHEIGHT 1\nDATA binary\n" +
                            std::string(300004, 'a');
  const PcdTable table = readPcd(folder.write("a.pcd", bytes));
  ASSERT_EQ(table.fields.size(), 1u);
  EXPECT_EQ(PcdColumn(table, 0).bits(0), 0x61616161u);
}

TEST(BadPcd, NothingButPadding)
{
  for (const std::string count : {"0", "4"})
    for (const std::string data : {"ascii", "binary", "binary_compressed"})
      EXPECT_TRUE(holds(refusal("FIELDS _\nSIZE 1\nTYPE U\nCOUNT " + count +
                                "\nWIDTH 1\nHEIGHT 1\nDATA " + data + "\n1 2 3 4\n"),
                        "has no field but padding"))
          << count << ' ' << data;
}
