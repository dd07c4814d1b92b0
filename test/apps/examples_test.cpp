// SPDX-License-Identifier: BSD-3-Clause

// Each example runs without arguments and with a user's data, and prints correct
// results.

#include "support/ascii_cloud.h"
#include "support/mapped_street.h"
#include "support/thrown_message.h"

#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>

namespace {

using namespace pcl_semantic;
namespace fs = std::filesystem;

const fs::path sources = PCL_SEMANTIC_SOURCE_DIR "/apps/examples";

// Runs an example, which must succeed without leaving files, and returns its output.
std::string
outputOf(const std::string& example, const std::string& arguments = "")
{
  const TemporaryFolder folder;
  const ToolResult result =
      runShell("cd " + folder.path() + "; exec " PCL_SEMANTIC_BINARY_DIR "/examples/" +
               example + " " + arguments + " 2>&1");
  EXPECT_EQ(result.code, 0) << result.text;
  EXPECT_EQ(folder.entries(), 0u);
  return result.text;
}

// The number behind the first match of `before`; -1 if there is none.
double
numberBehind(const std::string& text, const std::string& before)
{
  std::smatch match;
  return std::regex_search(text, match, std::regex(before + "(\\d+)"))
             ? std::stod(match[1])
             : -1.0;
}

// Lines of "number name": number by name.
std::map<std::string, int>
countsIn(const std::string& text)
{
  std::map<std::string, int> counts;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, std::regex("(\\d+) (\\w+)")))
      counts[match[2]] = std::stoi(match[1]);
  }
  return counts;
}

std::vector<std::uint32_t>
labelsOf(const std::string& path)
{
  std::vector<std::uint32_t> labels;
  const auto cloud = readLabelledCloud(path).cloud;
  for (const pcl::PointXYZRGBL& point : *cloud)
    labels.push_back(point.label);
  return labels;
}

// The example's own street, mapped once.
const std::string&
oneCall()
{
  static const std::string text = outputOf("01_one_call");
  return text;
}

// Of the tiny street, without CRF; made once.
const std::string&
coarseMap()
{
  static const TemporaryFolder folder;
  static const std::string path = [] {
    mapStreet(tinyStreet(), folder.path("map"), "--crf none --voxel-size 0.2");
    return folder.path("map/map.pcd");
  }();
  return path;
}

} // namespace

TEST(Examples, AreAllThatTheLadderHasAndStandAlone)
{
  int found = 0;
  for (const auto& entry : fs::directory_iterator(sources)) {
    if (entry.path().extension() != ".cpp")
      continue;
    ++found;
    EXPECT_TRUE(fs::exists(PCL_SEMANTIC_BINARY_DIR "/examples" / entry.path().stem()))
        << entry.path();
    const std::vector<std::string> lines = linesOf(entry.path().string());
    EXPECT_LE(lines.size(), 100u) << entry.path();
    for (const std::string& line : lines) // one file, the library, and the street
      EXPECT_TRUE(line.rfind("#include \"", 0) != 0 ||
                  line.rfind("#include \"synthesize/", 0) == 0)
          << entry.path() << ": " << line;
  }
  EXPECT_EQ(found, 8);
}

TEST(Examples, APclPipelineExtractsAClass)
{
  // Two walls of 2.5 m x 5 m, a point a voxel of 0.1 m: of 1,250 hardly one is wrong.
  EXPECT_NEAR(numberBehind(outputOf("08_pcl_pipeline"), "^"), 1250.0, 100.0);
  const TemporaryFolder folder;
  outputOf("08_pcl_pipeline", coarseMap() + " " + folder.path("road.pcd") + " 3");
  const auto labels = labelsOf(folder.path("road.pcd"));
  EXPECT_GT(labels.size(), 500u);
  EXPECT_EQ(std::count(labels.begin(), labels.end(), 3u),
            std::ptrdiff_t(labels.size()));
}

TEST(Examples, OneCallMapsTheStreetAsTheToolDoes)
{
  const auto counts = countsIn(oneCall());
  int sum = 0;
  for (const auto& [name, count] : counts)
    sum += count;
  EXPECT_EQ(sum, numberBehind(oneCall(), "^"));
  EXPECT_GT(counts.at("road"), 2000);
  EXPECT_GT(counts.at("building") + counts.at("vegetation"), counts.at("pole"));

  const TemporaryFolder folder;
  mapStreet(tinyStreet(), folder.path("map"), "");
  const std::string text =
      outputOf("01_one_call", tinyStreet() + " " + folder.path("one.pcd"));
  EXPECT_TRUE(bytesOf(folder.path("one.pcd")) ==
              bytesOf(folder.path("map/map_classes.pcd")));
  const auto labels = labelsOf(folder.path("map/map.pcd"));
  EXPECT_EQ(numberBehind(text, "^"), double(labels.size()));
  EXPECT_EQ(countsIn(text).at("road"), std::count(labels.begin(), labels.end(), 3u));
  // So does the example by hand.
  EXPECT_EQ(
      numberBehind(outputOf("03_map_and_crf_by_hand", tinyStreet()), "frame 2: .*\n"),
      numberBehind(text, "^"));
  const std::string by_hand = outputOf("03_map_and_crf_by_hand");
  const double voxels = numberBehind(by_hand, "frame 3: .*\n");
  EXPECT_GT(voxels, numberBehind(by_hand, "frame 0: .* hit "));
  EXPECT_GT(numberBehind(by_hand, "changed "), 0.005 * voxels);
  EXPECT_LT(numberBehind(by_hand, "changed "), 0.5 * voxels);
}

TEST(Examples, TheFilterMendsLabels)
{
  const std::string text = outputOf("02_filter_a_cloud");
  const double before = numberBehind(text, "wrong before: ");
  EXPECT_GT(before, 1000.0);
  EXPECT_LT(numberBehind(text, "wrong after: "), 0.95 * before);
  EXPECT_GE(numberBehind(text, "^"), before - numberBehind(text, "wrong after: "));
}

TEST(Examples, TheFilterGivesTheCloudOfTheTool)
{
  const TemporaryFolder folder;
  const std::string in = coarseMap();
  succeed("crf " + in + " " + folder.path("tool.pcd"));
  const std::string text =
      outputOf("02_filter_a_cloud", in + " " + folder.path("a.pcd"));
  const auto measured = labelsOf(in), refined = labelsOf(folder.path("a.pcd"));
  EXPECT_EQ(refined, labelsOf(folder.path("tool.pcd")));
  double changed = 0;
  for (std::size_t i = 0; i < measured.size(); ++i)
    changed += measured[i] != refined[i];
  EXPECT_GT(changed, 0);
  EXPECT_EQ(numberBehind(text, "^"), changed);
}

TEST(Examples, TheFilterTakesLabelsWithoutColourAndProbability)
{
  const TemporaryFolder folder;
  std::string points;
  for (int x = 0; x < 10; ++x)
    for (int y = 0; y < 10; ++y)
      points += std::to_string(0.1 * x) + " " + std::to_string(0.1 * y) + " 0 " +
                (x == 5 && y == 5 ? "2\n" : "1\n");
  const std::string in = folder.write("in.pcd", asciiCloud("x y z label", points));
  EXPECT_EQ(numberBehind(
                outputOf("02_filter_a_cloud", in + " " + folder.path("out.pcd")), "^"),
            1.0);
  EXPECT_EQ(labelsOf(folder.path("out.pcd")), std::vector<std::uint32_t>(100, 1u));
}

TEST(Examples, CloudsOfAnySensorMakeAMap)
{
  EXPECT_GT(numberBehind(outputOf("04_lidar_clouds"), "^"), 5000.0);

  // A sensor that looks at a wall from 3 m, then from 1 m farther left, turned by 90
  // degrees to the left, at a pole 5 m ahead of it.
  const TemporaryFolder folder;
  folder.write("0.pcd", asciiCloud("x y z label", "3.1 0.1 0.1 1\n3.1 0.3 0.1 1\n"));
  folder.write("1.pcd", asciiCloud("x y z label", "5.1 0.1 0.1 11\n5.1 0.1 0.3 11\n"));
  folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n0 -1 0 0 1 0 0 1 0 0 1 0\n");
  EXPECT_EQ(outputOf("04_lidar_clouds", folder.path() + " " + folder.path("map.pcd")),
            "4 voxels\n");
  std::map<std::uint32_t, Eigen::Vector3f> places;
  const auto cloud = readLabelledCloud(folder.path("map.pcd")).cloud;
  for (const pcl::PointXYZRGBL& point : *cloud)
    places[point.label] = point.getVector3fMap();
  ASSERT_EQ(places.size(), 2u);
  EXPECT_NEAR(places[1].x(), 3.1f, 1e-4f);
  EXPECT_NEAR(places[11].x(), -0.1f, 1e-4f);
  EXPECT_NEAR(places[11].y(), 6.1f, 1e-4f);
}

TEST(Examples, OwnCliquesMendWhatPointsAloneCannot)
{
  const std::string text = outputOf("05_own_cliques");
  const double measured = numberBehind(text, "measured: ");
  EXPECT_GT(measured, 200.0);
  EXPECT_LE(numberBehind(text, "dense: "), measured);
  EXPECT_LT(numberBehind(text, "columns: "), 0.4 * measured);
  EXPECT_EQ(numberBehind(text, "wrong\n(?=\\d+ cliques)"), 16.0);
}

TEST(Examples, TheSecondCameraSeesWhatTheFirstCannot)
{
  const std::string text = outputOf("06_two_cameras");
  EXPECT_GT(numberBehind(text, "front camera: "), 5000.0);
  EXPECT_EQ(numberBehind(text, "front camera: \\d+ voxels, "), 0.0);
  EXPECT_GT(numberBehind(text, "both: \\d+ voxels, "), 2000.0);
}

TEST(Examples, TheReaderSeesTheLastFrame)
{
  // The last snapshot is the finished map; how many come before is up to the reader.
  const std::string text = outputOf("07_live");
  const double voxels = numberBehind(oneCall(), "^");
  std::istringstream lines(text);
  std::string line, last;
  int snapshots = 0;
  double size = 0.0;
  while (std::getline(lines, line)) {
    EXPECT_GT(numberBehind(line, "^snapshot of "), size) << text;
    size = numberBehind(line, "^snapshot of ");
    last = line;
    ++snapshots;
  }
  EXPECT_GE(snapshots, 1);
  EXPECT_LE(snapshots, 4);
  EXPECT_EQ(size, voxels);
  EXPECT_GT(numberBehind(last, "live map knows "), 10000.0) << text;
}

TEST(Examples, BadInputEndsInOneLine)
{
  const TemporaryFolder folder;
  folder.write("empty.pcd", "");
  const std::string examples = PCL_SEMANTIC_BINARY_DIR "/examples/";
  for (const std::string& command : {"01_one_call " + folder.path("nowhere"),
                                     "02_filter_a_cloud " + folder.path("empty.pcd"),
                                     "03_map_and_crf_by_hand " + folder.path("nowhere"),
                                     "04_lidar_clouds " + folder.path("nowhere")}) {
    const ToolResult result = runShell("exec " + examples + command + " 2>&1");
    EXPECT_EQ(result.code, 1) << command;
    EXPECT_EQ(std::count(result.text.begin(), result.text.end(), '\n'), 1)
        << result.text;
    EXPECT_TRUE(holds(result.text, folder.path()));
  }
}
