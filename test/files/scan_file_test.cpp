// SPDX-License-Identifier: BSD-3-Clause

// Scans without a header: their columns, and the labels that belong to them.

#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/cloud_file.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <random>
#include <vector>

namespace pcl_semantic {

namespace {

namespace fs = std::filesystem;

using Row = std::vector<float>;
using MakeRow = std::function<Row(std::mt19937&, int)>;

float
between(std::mt19937& random, float low, float high)
{
  return std::uniform_real_distribution<float>(low, high)(random);
}

std::string
scanOf(int points, const MakeRow& make)
{
  std::mt19937 random(7);
  std::vector<float> values;
  for (int i = 0; i < points; ++i) {
    const Row row = make(random, i);
    values.insert(values.end(), row.begin(), row.end());
  }
  return {reinterpret_cast<const char*>(values.data()), 4 * values.size()};
}

// Points all around, in any order, with further columns.
Row
around(std::mt19937& random, int more, float largest)
{
  const float angle = between(random, 0.0f, 6.28f),
              range = between(random, 4.0f, 40.0f);
  Row row = {range * std::cos(angle), range * std::sin(angle), -1.8f};
  for (int k = 0; k < more; ++k)
    row.push_back(std::floor(between(random, 0.0f, largest)));
  return row;
}

} // namespace

TEST(ScanFile, ReadsNamedColumns)
{
  const TemporaryFolder folder;
  const std::string bytes = scanOf(40, [](auto& random, int i) {
    Row row = around(random, 2, 200.0f);
    row[4] = float(i % 32);
    return row;
  });
  const std::string path = folder.write("a.bin", bytes);
  folder.write("b.pcd.bin", bytes);
  for (const PcdTable& table :
       {readCloudTable(path, parseScanColumns("x,y,z,intensity,ring")),
        readCloudTable(path, parseScanColumns("5")),
        readCloudTable(folder.path("b.pcd.bin"))}) {
    ASSERT_EQ(table.points(), 40u);
    EXPECT_EQ(PcdColumn(table, table.find("ring"))(39), 7.0);
    EXPECT_EQ(PcdColumn(table, table.find("z"))(17), double(-1.8f));
    EXPECT_TRUE(table.doubts.empty());
  }
  const PcdTable swapped = readCloudTable(path, {"y", "x", "z", "_", "ring"});
  EXPECT_EQ(swapped.fields.size(), 4u);
  EXPECT_EQ(PcdColumn(swapped, swapped.find("ring"))(39), 7.0);
  for (const char* const text :
       {"x", "x,y", "x,y,z,z", "x,y,z,a b", "2", "17", "-5", "x,y,z,,i", "x,y,i"})
    EXPECT_THROW(parseScanColumns(text), InvalidParameterException) << text;
  EXPECT_TRUE(parseScanColumns("").empty()) << "the default";
}

TEST(ScanFile, RefusesOtherColumnsThanAssumed)
{
  struct Case {
    const char* what;
    MakeRow make;
    int columns;
  };
  for (const int points : {20, 100, 4000})
    for (const Case& each : std::vector<Case>{
             {"nuScenes", [](auto&random, int) { return around(random, 2, 256.0f); },
              5},
             {"colours", [](auto&random, int) { return around(random, 3, 256.0f); }, 6},
             {"seven", [](auto&random, int) { return around(random, 4, 256.0f); }, 7},
             {"eight", [](auto&random, int) { return around(random, 5, 256.0f); },
              8}}) {
      const TemporaryFolder folder;
      // Of a size that fits four columns, too.
      const std::string path = folder.write("a.bin", scanOf(points, each.make));
      EXPECT_TRUE(throws<BadInputException>(
          "does not look like x y z intensity, but like " +
              std::to_string(each.columns) + " float32 a point; name them with",
          [&] { readCloudTable(path); }))
          << each.what << " " << points;
      EXPECT_EQ(
          readCloudTable(path, parseScanColumns(std::to_string(each.columns))).points(),
          std::size_t(points));
      EXPECT_EQ(readCloudTable(path, parseScanColumns("4")).doubts.size(), 1u);
    }
  const TemporaryFolder folder;
  expectBadInput(
      "has 340 bytes, expected a multiple of 16 (4 float32 a point); it looks like 5",
      [&] {
        readCloudTable(folder.write("a.bin", scanOf(17, [](auto& random, int) {
                                      return around(random, 2, 256.0f);
                                    })));
      });
  std::vector<double> values;
  std::mt19937 random(1);
  for (int i = 0; i < 400; ++i)
    values.push_back(std::uniform_real_distribution<double>(-40, 40)(random));
  expectBadInput("positions are too large or too small for metres", [&] {
    readCloudTable(folder.write(
        "d.bin", {reinterpret_cast<const char*>(values.data()), 8 * values.size()}));
  });
}

TEST(ScanFile, AnEmptyOneHasNoPoints)
{
  const TemporaryFolder folder;
  const PcdTable table = readCloudTable(folder.write("a.bin", ""));
  EXPECT_EQ(table.points(), 0u);
  EXPECT_GE(table.find("x"), 0);
  ASSERT_EQ(table.doubts.size(), 1u);
  EXPECT_TRUE(holds(table.doubts[0], "a.bin: is empty: a scan of no points"));
  EXPECT_TRUE(readLabelledCloud(folder.path("a.bin")).cloud->empty());
}

TEST(ScanFile, ColumnsOfAnotherTypeAreRefused)
{
  expectBadParameter("'x:f8' states a type, but all columns of a .bin are float32",
                     [] { parseScanColumns("x:f8,y:f8,z:f8"); });
}

// Equal columns do not reveal their number, but intensities are never negative.
TEST(ScanFile, RefusesNegativeIntensitiesAndText)
{
  const TemporaryFolder folder;
  const std::string path =
      folder.write("a.bin", scanOf(400, [](auto& random, int) {
                     return Row{between(random, -9, 9), between(random, -9, 9),
                                between(random, -9, 9)};
                   }));
  expectBadInput("holds negative intensities, expected float32 x",
                 [&] { readCloudTable(path); });
  EXPECT_EQ(readCloudTable(path, parseScanColumns("3")).points(), 400u);
  EXPECT_EQ(readCloudTable(path, {"x", "y", "z", "doppler"}).points(), 300u);
  std::string text;
  for (int i = 0; i < 64; ++i)
    text += "1.25 2.50 3.75 4\n";
  expectBadInput("a.bin: is text, expected float32",
                 [&] { readCloudTable(folder.write("a.bin", text)); });
}

TEST(ScanFile, TakesScansOfFourColumnsForWhatTheyAre)
{
  const std::vector<std::pair<const char*, MakeRow>> scans = {
      {"intensity to 1",
       [](auto& random, int) {
         Row row = around(random, 1, 1.0f);
         row[3] = between(random, 0.0f, 1.0f);
         return row;
       }},
      {"intensity to 255", [](auto& random, int) { return around(random, 1, 256.0f); }},
      {"no intensity", [](auto& random, int) { return around(random, 1, 0.5f); }},
      {"a cube",
       [](auto& random, int) {
         return Row{between(random, -9, 9), between(random, -9, 9),
                    between(random, -9, 9), between(random, 0, 1)};
       }},
      {"all alike",
       [](auto& random, int) {
         std::normal_distribution<float> normal;
         return Row{normal(random), normal(random), normal(random),
                    std::abs(normal(random))};
       }},
      {"a grid",
       [](auto&, int i) {
         return Row{0.5f * float(i % 20), 0.5f * float(i / 20), 0.0f, 1.0f};
       }},
      {"no returns",
       [](auto&, int) {
         return Row{0, 0, 0, 0};
       }},
      {"two returns a beam",
       [](auto& random, int i) {
         Row row = around(random, 1, 256.0f);
         if (i % 2 == 1)
           row = {-row[0], -row[1], 2.0f, 0.0f};
         return row;
       }},
      {"three lasers take turns",
       [](auto& random, int i) {
         const float side = 20.0f * float(i % 3 - 1);
         return Row{side + between(random, -1, 1), -side + between(random, -1, 1),
                    between(random, -2, 2), between(random, 0, 255)};
       }},
      {"every second beam looks far, or does not come back",
       [](auto& random, int i) {
         Row row = around(random, 1, 256.0f);
         if (i % 2 == 1 && i < 2000)
           row = {9 * row[0], 9 * row[1], 3.0f, row[3]};
         else if (i % 2 == 1)
           row = {0, 0, 0, 0};
         return row;
       }},
      {"one point again and again", [](auto&, int) {
         return Row{3.5f, -2.0f, 1.0f, 0.25f};
       }}};
  for (const int points : {15, 20, 60, 105, 420, 4200}) // many numbers divide them
    for (const auto& [what, make] : scans) {
      const TemporaryFolder folder;
      const PcdTable table =
          readCloudTable(folder.write("a.bin", scanOf(points, make)));
      EXPECT_EQ(table.points(), std::size_t(points)) << what;
      EXPECT_TRUE(table.doubts.empty()) << what;
    }
}

TEST(ScanFile, RealScansAreReadWithoutADoubt)
{
  const char* const data = std::getenv("PCL_SEMANTIC_DATA");
  if (!data)
    GTEST_SKIP() << "PCL_SEMANTIC_DATA is not set";
  for (const fs::directory_entry& entry :
       fs::recursive_directory_iterator(std::string(data) + "/kitti"))
    if (entry.path().parent_path().filename() == "velodyne") {
      EXPECT_TRUE(readCloudTable(entry.path().string()).doubts.empty());
    }
  const std::string nuscenes = std::string(data) + "/clouds/nuscenes_lidar_top.pcd.bin";
  const PcdTable table = readCloudTable(nuscenes);
  EXPECT_EQ(table.points(), 34688u);
  const PcdColumn ring(table, table.find("ring"));
  for (std::size_t i = 0; i < table.points(); ++i)
    ASSERT_TRUE(ring(i) >= 0.0 && ring(i) <= 31.0);
  const TemporaryFolder folder;
  fs::copy_file(nuscenes, folder.path("a.bin"));
  expectBadInput("but like 5 float32 a point",
                 [&] { readCloudTable(folder.path("a.bin")); });
}

// `velodyne` is a link to the scans of another drive; the labels are our own.
TEST(ScanFile, LabelsLieBesideThePathThatWasGiven)
{
  const TemporaryFolder folder;
  const auto text = [](std::uint32_t label) {
    return std::string(reinterpret_cast<const char*>(&label), 4);
  };
  for (const char* const name : {"A/velodyne", "A/labels", "B/labels"})
    fs::create_directories(folder.path(name));
  fs::create_directory_symlink("../A/velodyne", folder.path("B/velodyne"));
  folder.write("A/velodyne/000000.bin", std::string(16, '\0'));
  folder.write("A/labels/000000.label", text(1));
  folder.write("B/labels/000000.label", text(2));
  const auto labelOf = [&](const std::string& path) {
    return readLabelledCloud(path).cloud->front().label;
  };
  EXPECT_EQ(labelOf(folder.path("A/velodyne/000000.bin")), 1u);
  EXPECT_EQ(labelOf(folder.path("B/velodyne/000000.bin")), 2u);
  EXPECT_EQ(labelOf(folder.path("B/velodyne/../velodyne/./000000.bin")), 2u);
  EXPECT_EQ(labelOf(folder.path("B//velodyne//000000.bin")), 2u);
  const fs::path before = fs::current_path();
  fs::current_path(folder.path("B"));
  EXPECT_EQ(labelOf("velodyne/000000.bin"), 2u);
  EXPECT_EQ(labelOf("./velodyne/000000.bin"), 2u);
  ::setenv("PWD", folder.path("B/velodyne").c_str(), 1); // as in a shell
  fs::current_path(folder.path("B/velodyne"));
  EXPECT_EQ(labelOf("000000.bin"), 2u);
  EXPECT_EQ(labelOf("./000000.bin"), 2u);
  fs::current_path(folder.path("A/velodyne"));
  ::unsetenv("PWD");
  EXPECT_EQ(labelOf("000000.bin"), 1u);
  fs::create_directories(folder.path("A/velodyne/deeper"));
  fs::current_path(folder.path("A/velodyne/deeper"));
  EXPECT_EQ(labelOf("../000000.bin"), 1u);
  fs::current_path(before);
}

TEST(ScanFile, SaysWhatFilesOfOtherFormatsAre)
{
  const std::string pointer = "version https://git-lfs.github.com/spec/v1\n"
                              "oid sha256:4d7a\nsize 123\n";
  struct Case {
    std::string name, bytes, part;
  };
  for (const Case& each :
       std::vector<Case>{{"a.las", "LASF",
                          "is LAS, expected .pcd, .ply or .bin; convert it: pdal tr"},
                         {"a.LAZ", "LASF", "a.LAZ: is LAZ, expected"},
                         {"a.pcd", "LASF and more", "a.pcd: is LAS, expected"},
                         {"a.e57", "ASTM-E57", "is E57, expected"},
                         {"a.xyz", "1 2 3\n", "is text, expected"},
                         {"a.npy", "\x93NUMPY", "write_cloud()"},
                         {"a.pcd", pointer,
                          "Git LFS pointer, expected .pcd, .ply or .bin; git lfs pull"},
                         {"a.ply", pointer, "Git LFS pointer"},
                         {"a.bin", pointer, "Git LFS pointer"},
                         {"a.las", pointer, "expected .pcd, .ply or .bin"}}) {
    const TemporaryFolder folder;
    const std::string path = folder.write(each.name, each.bytes);
    expectBadInput(each.part, [&] { readCloudTable(path); });
  }
}

} // namespace pcl_semantic
