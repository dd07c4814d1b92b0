// SPDX-License-Identifier: BSD-3-Clause

// Clouds that are read in tiles, because --memory is too small for them: the results
// are those of the whole cloud in memory.

#include "support/column_of.h"
#include "support/run_tool.h"
#include "support/temporary_folder.h"

#include <pcl_semantic/files/cloud_file.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace pcl_semantic {

namespace {

constexpr int kSide = 480; // points
constexpr double kStep = 0.05;
constexpr const char* kSmall = " --memory 0.3 --quiet --json";
constexpr const char* kLarge = " --memory 64 --quiet --json";

// A wavy surface of squares of eleven classes, a third of whose labels is wrong, with a
// point without a position and two without a return.
template <typename T>
PcdTable
survey(const Eigen::Vector3d& shift)
{
  std::mt19937 random(11);
  std::vector<T> x, y, z;
  std::vector<std::uint8_t> labels;
  std::vector<std::uint32_t> colours;
  std::vector<float> numbers;
  for (int i = 0; i < kSide * kSide; ++i) {
    const double u = i % kSide * kStep, v = i / kSide * kStep;
    const int label = 1 + (int(u / 2.0) * 7 + int(v / 2.0) * 13) % 11;
    x.push_back(T(u + shift.x()));
    y.push_back(T(v + shift.y()));
    z.push_back(T(std::sin(u) + std::cos(v / 2.0) + shift.z()));
    labels.push_back(std::uint8_t(random() % 3 == 0 ? 1 + random() % 11 : label));
    colours.push_back(0xFF000000u | std::uint32_t(label) * 0x0B1517u);
    numbers.push_back(float(i));
  }
  x[1000] = std::numeric_limits<T>::quiet_NaN();
  for (const std::size_t i : {70000u, 200000u})
    x[i] = y[i] = z[i] = T(0);
  PcdTable table;
  table.width = kSide;
  table.height = kSide;
  table.setColumn("x", x);
  table.setColumn("y", y);
  table.setColumn("z", z);
  table.setColumn("rgba", colours);
  table.setColumn("label", labels);
  table.setColumn("number", numbers);
  return table;
}

double
shareOfEqual(const std::vector<double>& a, const std::vector<double>& b)
{
  std::size_t equal = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    equal += a[i] == b[i];
  return double(equal) / double(a.size());
}

class LargeClouds : public testing::Test {
protected:
  static void
  SetUpTestSuite()
  {
    folder = std::make_unique<TemporaryFolder>();
    writeCloudTable(folder->path("in.pcd"), survey<float>(Eigen::Vector3d::Zero()));
  }

  static void
  TearDownTestSuite()
  {
    folder.reset();
  }

  // Results with little and with much memory; each output is read again.
  static std::pair<PcdTable, PcdTable>
  both(const std::string& program, const std::string& options,
       const std::string& input = "in.pcd")
  {
    const std::string files =
        program + " " + folder->path(input) + " " + folder->path("out.pcd") + " ";
    const std::string tiles = succeed(files + options + kSmall);
    PcdTable small = readCloudTable(folder->path("out.pcd"));
    const std::string whole = succeed(files + options + kLarge);
    EXPECT_EQ(whole.find("\"tiles\""), std::string::npos) << whole;
    return {std::move(small), readCloudTable(folder->path("out.pcd"))};
  }

  // Expects the points of the input in its order, with all its fields.
  static void
  expectPointsOfInput(const PcdTable& table)
  {
    EXPECT_EQ(table.width, pcl::uindex_t(kSide));
    EXPECT_EQ(table.height, pcl::uindex_t(kSide));
    const PcdTable input = readCloudTable(folder->path("in.pcd"));
    for (const char* const name : {"y", "z", "number"})
      EXPECT_TRUE(columnOf(table, name) == columnOf(input, name)) << name;
  }

  static inline std::unique_ptr<TemporaryFolder> folder;
};

} // namespace

TEST_F(LargeClouds, HaveTheLabelsOfOnePiece)
{
  folder->write("lattice.yaml", "crf_kernels: lattice\n");
  for (const std::string& options :
       {std::string(), std::string("--crf unary"), std::string("--crf-sensor rgbd"),
        std::string("--crf-iterations 1"),
        "--config " + folder->path("lattice.yaml")}) {
    SCOPED_TRACE(options);
    const auto [tiles, whole] = both("crf", options);
    expectPointsOfInput(tiles);
    EXPECT_GE(shareOfEqual(columnOf(tiles, "label"), columnOf(whole, "label")), 0.9999);
    const auto p = columnOf(tiles, "probability"), q = columnOf(whole, "probability");
    double difference = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i)
      difference += std::abs(p[i] - q[i]) / double(p.size());
    EXPECT_LT(difference, 1e-4);
  }
}

TEST_F(LargeClouds, ReadTheirOwnProbabilities)
{
  succeed("crf " + folder->path("in.pcd") + " " + folder->path("once.pcd") + kLarge);
  const auto [tiles, whole] = both("crf", "", "once.pcd");
  EXPECT_GE(shareOfEqual(columnOf(tiles, "label"), columnOf(whole, "label")), 0.9999);
  std::filesystem::remove(folder->path("once.pcd"));
}

TEST_F(LargeClouds, ReportTheFiguresOfThePoints)
{
  const std::string report =
      succeed("crf " + folder->path("in.pcd") + " " + folder->path("out.pcd") + kSmall);
  EXPECT_TRUE(holds(report, "\"points\": 230400"));
  EXPECT_TRUE(holds(report, "\"without_place\": 3"));
  EXPECT_TRUE(holds(report, "\"cliques_cut_by_tiles\": 0"));
  EXPECT_FALSE(holds(report, "\"tiles\": 1,"));
}

TEST_F(LargeClouds, KeepThePrecisionOfASurvey)
{
  const Eigen::Vector3d shift(691000.3, 5335000.7, 520.0);
  writeCloudTable(folder->path("far.pcd"), survey<double>(shift));
  const auto [tiles, whole] = both("crf", "", "far.pcd");
  EXPECT_GE(shareOfEqual(columnOf(tiles, "label"), columnOf(whole, "label")), 0.9999);
  const PcdTable input = readCloudTable(folder->path("far.pcd"));
  for (const char* const name : {"y", "z"})
    EXPECT_TRUE(columnOf(tiles, name) == columnOf(input, name)) << name;
  std::filesystem::remove(folder->path("far.pcd"));
}

TEST_F(LargeClouds, AreEditedAsOnePiece)
{
  for (const char* const options :
       {"--drop 3,5", "--crop 1,1,-5,9,9,5", "--relabel 2=4", "--keep 7"}) {
    SCOPED_TRACE(options);
    const auto [tiles, whole] = both("cloud", options);
    EXPECT_EQ(tiles.width, whole.width);
    EXPECT_EQ(tiles.height, whole.height);
    EXPECT_TRUE(tiles.data == whole.data);
  }
}

TEST_F(LargeClouds, AreThinnedToTheSamePoints)
{
  const auto pointsOf = [](const PcdTable& table) {
    std::map<double, double> points;
    const auto numbers = columnOf(table, "number"), labels = columnOf(table, "label");
    for (std::size_t i = 0; i < numbers.size(); ++i)
      points[numbers[i]] = labels[i];
    return points;
  };
  const auto [tiles, whole] = both("cloud", "--thin 0.13");
  EXPECT_EQ(tiles.width, whole.width);
  EXPECT_TRUE(pointsOf(tiles) == pointsOf(whole));
}

TEST_F(LargeClouds, HaveOneNumberForEachClique)
{
  const auto [tiles, whole] = both("cliques", "--method cubes:1");
  expectPointsOfInput(tiles);
  const auto numbers = columnOf(tiles, "clique"), expected = columnOf(whole, "clique");
  std::set<std::pair<double, double>> pairs;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    ASSERT_EQ(numbers[i] == 0.0, expected[i] == 0.0) << i;
    pairs.emplace(numbers[i], expected[i]);
  }
  // A number belongs to one cube. Cubes at the edges of tiles have several numbers.
  std::set<double> found;
  for (const auto& [number, cube] : pairs)
    EXPECT_TRUE(found.insert(number).second || number == 0.0) << number;
  EXPECT_LT(double(pairs.size()),
            1.5 * *std::max_element(expected.begin(), expected.end()));
}

TEST_F(LargeClouds, TellHowManyCliquesTheirTilesCut)
{
  succeed("cliques " + folder->path("in.pcd") + " " + folder->path("grouped.pcd") +
          " --method cubes:0.5" + kLarge);
  const std::string hierarchical = " --crf hierarchical --cliques ";
  for (const char* const cliques : {"field", "cubes:0.5", "planes"}) {
    SCOPED_TRACE(cliques);
    const auto [tiles, whole] = both("crf", hierarchical + cliques, "grouped.pcd");
    EXPECT_GE(shareOfEqual(columnOf(tiles, "label"), columnOf(whole, "label")), 0.99);
    const std::string report =
        succeed("crf " + folder->path("grouped.pcd") + " " + folder->path("out.pcd") +
                hierarchical + cliques + kSmall);
    EXPECT_FALSE(holds(report, "\"cliques_cut_by_tiles\": 0"));
  }
  std::filesystem::remove(folder->path("grouped.pcd"));
}

TEST_F(LargeClouds, RefuseWhatNeedsTheWholeCloud)
{
  PcdTable table = survey<float>(Eigen::Vector3d::Zero());
  table.removeColumns("rgba");
  for (const char* const name : {"red", "green", "blue"})
    table.setColumn(name, std::vector<std::uint16_t>(table.points(), 60000));
  writeCloudTable(folder->path("channels.pcd"), table);
  const std::string out = " " + folder->path("refused.pcd") + " ";
  expectFails("crf " + folder->path("channels.pcd") + out + kSmall, 3,
              "colours are in one field each");
  std::filesystem::remove(folder->path("channels.pcd"));
  const std::string in = folder->path("in.pcd") + out;
  expectFails("crf " + in + "--memory 0.1", 2, "--memory is 0.1 GB");
  expectFails("cliques " + in + "--method planes --coloured " +
                  folder->path("colours.pcd") + kSmall,
              2, "--coloured and --frame need the whole cloud");
  folder->write("cliques.txt", "0 1 2\n");
  expectFails("crf " + in + "--crf hierarchical --cliques " +
                  folder->path("cliques.txt") + kSmall,
              2, "need the whole cloud in memory");
  EXPECT_FALSE(std::filesystem::exists(folder->path("refused.pcd")));
}

TEST_F(LargeClouds, LeaveNothingOnAFullDisk)
{
  const ToolResult result = runTool(
      "crf " + folder->path("in.pcd") + " " + folder->path("full/out.pcd") + kSmall,
      "mkdir -p " + folder->path("full") + "; ulimit -f 2000;");
  EXPECT_EQ(result.code, 5) << result.text;
  EXPECT_TRUE(std::filesystem::is_empty(folder->path("full")));
}

} // namespace pcl_semantic
