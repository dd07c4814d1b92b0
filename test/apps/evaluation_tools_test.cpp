// SPDX-License-Identifier: BSD-3-Clause
#include "support/bad_case.h"
#include "support/run_tool.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/dataset/lidar_scan.h>
#include <pcl_semantic/evaluation/depth_file.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/images/image_file.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include <cstdlib>
#include <fstream>
#include <regex>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

const std::string label_mapping = " --label-mapping " PCL_SEMANTIC_SOURCE_DIR
                                  "/data/label_mappings/semantic_kitti_to_kitti11.yaml";

void
writeImage(const std::string& folder, const std::string& name, const cv::Mat1b& image)
{
  fs::create_directories(folder);
  writePng(folder + "/" + name, image);
}

class EvaluateTool : public testing::Test {
protected:
  EvaluateTool()
  {
    // Two folders of truth, to be pooled: 6 pixels of road and 2 of building.
    const cv::Mat1b road(2, 3, Label(3)), building(2, 2, Label(1));
    for (const char* const name : {"t1", "p1", "c1"})
      writeImage(folder_.path(name), "000000.png", road);
    writeImage(folder_.path("t2"), "000004.png", building);
    writeImage(folder_.path("p2"), "000004.png", (cv::Mat1b(2, 2) << 1, 3, 0, 2));
    writeImage(folder_.path("c2"), "000004.png", (cv::Mat1b(2, 2) << 7, 0, 0, 0));
  }

  std::string
  pair(const std::string& number) const
  {
    return " --prediction " + folder_.path("p" + number) + " --truth " +
           folder_.path("t" + number);
  }

  TemporaryFolder folder_;
};

} // namespace

TEST_F(EvaluateTool, MapsTheNumbersOfTruthImages)
{
  cv::Mat1b truth(4, 11);
  for (int i = 0; i < 44; ++i)
    truth.data[i] = std::uint8_t(i % 11 + 1);
  writeImage(folder_.path("p3"), "000000.png", truth);
  writeImage(folder_.path("t3"), "000000.png", truth - 1);
  const std::string command = "evaluate" + pair("3") + of_kitti11 + "--ignore none ";
  EXPECT_TRUE(holds(succeed(command + "--label-mapping zero_based"),
                    "mean                100.0"));
  EXPECT_TRUE(
      holds(succeed(command), "predictions are one more than the ground truth"));

  cv::Mat3b colours(4, 11);
  const LabelSet classes = readLabelSet(kitti11);
  for (int i = 0; i < 44; ++i) {
    const auto& rgb = classes[Label(truth.data[i])].colour;
    colours(i / 11, i % 11) = cv::Vec3b(rgb[2], rgb[1], rgb[0]);
  }
  writePng(folder_.path("t3/000000.png"), colours);
  EXPECT_TRUE(
      holds(succeed(command + "--label-mapping colours"), "mean                100.0"));
}

TEST_F(EvaluateTool, PoolsAndWrites)
{
  const std::string both = "evaluate" + pair("1") + pair("2") + of_kitti11;
  const std::string row =
      succeed(both + " --header --row both --output " + (folder_.path("out")));
  // Road: 6 right, 1 false positive. Building: 1 right, 2 wrong, 1 uncovered.
  EXPECT_TRUE(holds(row, "| both | 33.3 | 85.7 | - |"));
  EXPECT_TRUE(holds(row, "| 59.5 | 77.8 | 55.4 | 90.0 |"));
  EXPECT_EQ(row.rfind("| | building | road | vegetation | sidewalk | car | sign |", 0),
            0u);
  std::ifstream stream(folder_.path("out/metrics.json"));
  EXPECT_NEAR(nlohmann::json::parse(stream)["coverage"], 0.9, 1e-12);
  EXPECT_TRUE(fs::exists(folder_.path("out/confusion.csv")));

  const ToolResult covered =
      runTool(both + " --row x --covered-by " + (folder_.path("c1")) +
              " --covered-by " + (folder_.path("c2")));
  EXPECT_TRUE(holds(covered.text, "| x | 100.0 | 100.0 |"));
  const ToolResult without = runTool(both + " --row x --ignore 3,building,sky");
  EXPECT_EQ(without.text.rfind("| x | - | - |", 0), 0u) << without.text;
  const ToolResult table = runTool(both);
  EXPECT_TRUE(holds(table.text, "coverage"));
}

TEST_F(EvaluateTool, CountsEachRangeByItself)
{
  // Road at 5 m (two pixels), at 10 m (one wrong, one right, one uncovered) and at no
  // depth (one); building beyond 20 m.
  writeImage(folder_.path("p1"), "000000.png", (cv::Mat1b(2, 3) << 3, 3, 1, 3, 0, 3));
  fs::create_directories(folder_.path("d1"));
  fs::create_directories(folder_.path("d2"));
  writeDepthImage(folder_.path("d1/000000.png"),
                  (cv::Mat1f(2, 3) << 5, 5, 10, 10, 10, 0));
  writeDepthImage(folder_.path("d2/000004.png"), cv::Mat1f(2, 2, 39.0f));
  const std::string depths =
      " --truth-depth " + folder_.path("d1") + " --truth-depth " + folder_.path("d2");
  const std::string rows =
      succeed("evaluate" + pair("1") + pair("2") + of_kitti11 + depths +
              " --range 0:10 --range 10:20 --range 20: --row map");
  EXPECT_EQ(
      rows,
      "| map, 0-10 m | - | 100.0 | - | - | - | - | - | - | 100.0 | 100.0 | 100.0 "
      "| 100.0 |\n"
      "| map, 10-20 m | - | 50.0 | - | - | - | - | - | - | 50.0 | 50.0 | 33.3 | 66.7 "
      "|\n"
      "| map, from 20 m | 33.3 | - | - | - | - | - | - | - | 33.3 | 33.3 | 25.0 | "
      "75.0 |\n");
  const ToolResult table = runTool("evaluate" + pair("1") + pair("2") + of_kitti11 +
                                   depths + " --range 0:10 --range 10:20");
  EXPECT_TRUE(holds(table.text, "\n10-20 m\nclass"));

  const std::string one = "evaluate" + pair("1") + of_kitti11;
  expectFails(one + " --range 0:10", 2, "belong together");
  expectFails(one + " --truth-depth " + folder_.path("d1"), 2, "belong together");
  const std::string with_depth = one + " --truth-depth " + folder_.path("d1");
  for (const char* range : {"10:5", "5", "a:b", "-1:5", "3:3", "nan:9", "1:2:3"})
    expectFails(with_depth + " --range " + range, 2, "--range is '");
  expectFails(with_depth + " --range 0:1 --range 1:2 --output " + folder_.path("o"), 2,
              "one --range");
  expectFails(one + " --range 0:10 --truth-depth " + folder_.path("d2"), 3,
              "d2/000000.png");
  writeDepthImage(folder_.path("d1/000000.png"), cv::Mat1f(2, 2, 5.0f));
  expectFails(with_depth + " --range 0:10", 3,
              "has 2 x 2 depths, the ground truth 3 x 2");
}

TEST_F(EvaluateTool, TakesLabelsOfScans)
{
  for (const char* name : {"p", "t", "raw", "d"})
    fs::create_directories(folder_.path(name));
  writeScanLabels(folder_.path("p/000003.label"), {3, 3, 1, 0, 1});
  writeScanLabels(folder_.path("t/000003.label"), {3, 1, 1, 1, 0});
  const float depths[] = {4.0f, 4.0f, 30.0f, 30.0f, 4.0f};
  std::ofstream(folder_.path("d/000003.bin"), std::ios::binary)
      .write(reinterpret_cast<const char*>(depths), sizeof(depths));
  // The same truth in SemanticKITTI's numbers: 40 is road, 50 building, 0 nothing.
  writeScanLabels(folder_.path("raw/000003.label"), {40, 50, 50, 50, 0});
  const std::string begin =
      "evaluate --prediction " + folder_.path("p") + of_kitti11 + "--row x ";
  const std::string ours = begin + " --truth " + folder_.path("t");
  const std::string raw = begin + " --truth " + folder_.path("raw");
  const std::string expected = "| x | 50.0 | 50.0 | - |";
  EXPECT_EQ(runTool(ours).text.rfind(expected, 0), 0u) << runTool(ours).text;
  EXPECT_EQ(runTool(raw + label_mapping).text, runTool(ours).text);
  const ToolResult near =
      runTool(ours + " --range 0:10 --truth-depth " + folder_.path("d"));
  EXPECT_EQ(near.text.rfind("| x, 0-10 m | 0.0 | 50.0 | - |", 0), 0u) << near.text;
  const ToolResult covered = runTool(ours + " --covered-by " + folder_.path("t"));
  EXPECT_EQ(covered.text.rfind(expected, 0), 0u) << covered.text;

  expectFails(raw, 3, "point 0 has class 40");
  writeScanLabels(folder_.path("p/000003.label"), {3, 3, 1});
  expectFails(raw + label_mapping, 3, "000003.label: has 20 bytes, expected 12");
  expectFails(ours, 3, "has 3 x 1 pixels, the ground truth 5 x 1");
}

namespace {

// A box of 64 points, 1 m wide, that begins at x.
void
addBox(std::string& scan, float x)
{
  for (int i = 0; i < 64; ++i) {
    const float point[] = {x + float(i / 16) / 3.0f, float(i / 4 % 4) / 3.0f,
                           float(i % 4) / 3.0f, 0.5f};
    scan.append(reinterpret_cast<const char*>(point), sizeof(point));
  }
}

// Numbers of 64 points each.
std::string
numbersOf(const std::vector<std::uint32_t>& numbers)
{
  std::string bytes;
  for (const std::uint32_t number : numbers)
    for (int i = 0; i < 64; ++i)
      bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
  return bytes;
}

} // namespace

TEST_F(EvaluateTool, ComparesObjectsOfScans)
{
  for (const char* const name : {"p", "t", "s", "c"})
    fs::create_directories(folder_.path(name));
  std::string scan;
  for (const float x : {5.0f, 15.0f, 25.0f})
    addBox(scan, x);
  // In SemanticKITTI's numbers: a truck, a driving car and a road. Both objects are
  // cars with the number 1. The second frame gives the truck another number and takes
  // the car for a road.
  const std::uint32_t truck = 18 | 1u << 16, driving = 252 | 1u << 16, road = 40;
  for (const char* const name : {"000003", "000004"}) {
    folder_.write("s/" + std::string(name) + ".bin", scan);
    folder_.write("t/" + std::string(name) + ".label",
                  numbersOf({truck, driving, road}));
    folder_.write("c/" + std::string(name) + ".label", numbersOf({1, 0, 1}));
  }
  folder_.write("p/000003.label", numbersOf({6 | 7u << 16, 6 | 8u << 16, 3}));
  folder_.write("p/000004.label", numbersOf({6 | 9u << 16, 3, 3}));
  const std::string pair =
      " --prediction " + folder_.path("p") + " --truth " + folder_.path("t");
  const std::string command = "evaluate --panoptic" + of_kitti11 + label_mapping;
  const std::string scans = " --scans " + folder_.path("s");

  const auto tableOf = [](const std::string& arguments) {
    return std::regex_replace(succeed(arguments), std::regex(" +"), " ");
  };
  const std::string text =
      tableOf(command + pair + scans + " --output " + folder_.path("out"));
  // The road is found in one of two frames.
  for (const char* const line :
       {"road 50.0 100.0 50.0 2 1 1 - -\n", "car 85.7 100.0 85.7 4 3 0 75.0 75.0\n",
        "pedestrian - - - 0 0 0 - -\n", "things 85.7 100.0 85.7 4 3 0 75.0 75.0\n",
        "all 67.9 100.0 67.9 6 4 1 75.0 75.0\n",
        "0-10 m 100.0 100.0 100.0 2 2 0 100.0 100.0\n",
        "10-20 m 66.7 100.0 66.7 2 1 0 50.0 50.0\n",
        "association 37.5\nswitches 1\nobjects 2\n"})
    EXPECT_TRUE(holds(text, line)) << text;
  const auto json = nlohmann::json::parse(bytesOf(folder_.path("out/panoptic.json")));
  EXPECT_EQ(json["classes"].size(), 11u);
  EXPECT_EQ(json["classes"][5]["name"], "car");
  EXPECT_EQ(json["classes"][5]["matched"], 3);
  EXPECT_EQ(json["classes"][5]["distances"][1]["from"], 10.0);
  EXPECT_EQ(json["classes"][5]["distances"][1]["box_recall_25"], 0.5);
  EXPECT_NEAR(json["things"]["pq"], 6.0 / 7.0, 1e-12);
  EXPECT_EQ(json["things"]["distances"].size(), 4u);
  EXPECT_TRUE(json["classes"][0]["pq"].is_null());
  EXPECT_EQ(json["switches"], 1);
  EXPECT_EQ(nlohmann::json::parse(succeed(command + pair + scans + " --json")), json);

  EXPECT_FALSE(holds(tableOf(command + pair), "10-20 m"));
  // Two sequences: a number may mean another object in the second one.
  EXPECT_TRUE(holds(tableOf(command + pair + pair), "switches 2\nobjects 4\n"));
  EXPECT_TRUE(holds(tableOf(command + pair + " --ignore car"), "objects 0\n"));
  const std::string covered =
      tableOf(command + pair + " --covered-by " + folder_.path("c"));
  EXPECT_TRUE(holds(covered, "car 100.0 100.0 100.0 2 2 0 - -\n"));
  EXPECT_TRUE(holds(covered, "objects 1\n"));
}

TEST_F(EvaluateTool, RefusesObjectsThatDoNotFit)
{
  for (const char* const name : {"p", "t", "s", "none"})
    fs::create_directories(folder_.path(name));
  std::string scan;
  addBox(scan, 5.0f);
  folder_.write("s/000003.bin", scan);
  folder_.write("t/000003.label", numbersOf({6 | 1u << 16}));
  const std::string prediction =
      folder_.write("p/000003.label", numbersOf({6 | 2u << 16}));
  const std::string pair =
      " --prediction " + folder_.path("p") + " --truth " + folder_.path("t");
  const std::string command = "evaluate --panoptic" + of_kitti11 + pair;
  succeed(command + " --scans " + folder_.path("s"));

  for (const char* const option :
       {"--row x", "--header", "--range 0:9", "--truth-depth d"})
    expectFails(command + " " + option, 2, "has no effect with --panoptic");
  expectFails("evaluate" + of_kitti11 + pair + " --scans " + folder_.path("s"), 2,
              "--scans has no effect without --panoptic");
  expectFails(command + " --scans s1 --scans s2", 2, "given 1 and 2 times");
  expectFails(command + " --label-mapping colours", 3, "--label-mapping maps colours");
  expectFails(command + " --scans " + folder_.path("none"), 3, "none/000003.bin");
  expectFails(command + " --covered-by " + folder_.path("none"), 3,
              "none/000003.label");
  expectFails("evaluate --panoptic" + of_kitti11 + " --truth " + folder_.path("none") +
                  " --prediction " + folder_.path("p"),
              3, "none: holds no ground truth, expected 000000.label");
  EXPECT_TRUE(holds(succeed(command + label_mapping), "nothing to compare with"));
  folder_.write("s/000003.bin", scan.substr(16));
  expectFails(command + " --scans " + folder_.path("s"), 3,
              "s/000003.bin: has 63 points, expected 64 as ");
  folder_.write("p/000003.label", numbersOf({6, 6}));
  expectFails(command, 3, "p/000003.label: has 128 points, expected 64 as ");
  folder_.write("p/000003.label", "12345");
  expectFails(command, 3, "p/000003.label: has 5 bytes");
  folder_.write("p/000003.label", numbersOf({12}));
  expectFails(command, 3, "p/000003.label: point 0 has class 12, expected 0 to 11");
  fs::remove(prediction);
  expectFails(command, 3, "p/000003.label");
}

TEST_F(EvaluateTool, RefusesBadInput)
{
  const std::string one = "evaluate" + pair("1") + of_kitti11;
  for (const auto& [command, code, says] :
       {std::tuple("evaluate" + pair("1"), 2, "label-set"),
        {one + " --misspelt", 2, "misspelt"},
        {one + " --ignore 12", 2, "'12'"},
        {one + " --ignore skye", 2, "'skye'"},
        {one + " --truth " + folder_.path("t2"), 2, "given 2 and 1 times"},
        {replaceAll(one, "/t1", "/t2"), 3, "p1/000004.png: is missing"},
        {one + " --covered-by " + folder_.path("c2"), 3, "c2/000000.png"},
        {one + " --output /dev/null/x", 5, "/dev/null/x"}})
    expectFails(command, code, says);
  writeTextFile(folder_.path("p1/000000.png"), "no image");
  expectFails(one, 3, "p1/000000.png");
  writeImage(folder_.path("p1"), "000000.png", cv::Mat1b(2, 3, Label(12)));
  expectFails(one, 3, "label 12");
}

} // namespace pcl_semantic
