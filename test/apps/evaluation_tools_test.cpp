// SPDX-License-Identifier: BSD-3-Clause
#include "support/run_tool.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/dataset/lidar_scan.h>
#include <pcl_semantic/evaluation/depth_file.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/image_file.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include <cstdlib>
#include <fstream>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

const std::string data = std::string(PCL_SEMANTIC_SOURCE_DIR) + "/data";
const std::string label_set = " --label-set " + data + "/label_sets/kitti11.yaml";
const std::string label_mapping =
    " --label-mapping " + data + "/label_mappings/semantic_kitti_to_kitti11.yaml";

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
    writeImage(folder_.path("t1"), "000000.png", road);
    writeImage(folder_.path("p1"), "000000.png", road);
    writeImage(folder_.path("t2"), "000004.png", building);
    writeImage(folder_.path("p2"), "000004.png", (cv::Mat1b(2, 2) << 1, 3, 0, 2));
    writeImage(folder_.path("c1"), "000000.png", road);
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

TEST_F(EvaluateTool, PoolsAndWrites)
{
  const std::string both = "evaluate" + pair("1") + pair("2") + label_set;
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
      succeed("evaluate" + pair("1") + pair("2") + label_set + depths +
              " --range 0:10 --range 10:20 --range 20: --row map");
  EXPECT_EQ(
      rows,
      "| map, 0-10 m | - | 100.0 | - | - | - | - | - | - | 100.0 | 100.0 | 100.0 "
      "| 100.0 |\n"
      "| map, 10-20 m | - | 50.0 | - | - | - | - | - | - | 50.0 | 50.0 | 33.3 | 66.7 "
      "|\n"
      "| map, from 20 m | 33.3 | - | - | - | - | - | - | - | 33.3 | 33.3 | 25.0 | "
      "75.0 |\n");
  const ToolResult table = runTool("evaluate" + pair("1") + pair("2") + label_set +
                                   depths + " --range 0:10 --range 10:20");
  EXPECT_TRUE(holds(table.text, "\n10-20 m\nclass"));

  const std::string one = "evaluate" + pair("1") + label_set;
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
  writePointDepths(folder_.path("d/000003.bin"), {4.0f, 4.0f, 30.0f, 30.0f, 4.0f});
  // The same truth in SemanticKITTI's numbers: 40 is road, 50 building, 0 nothing.
  writeScanLabels(folder_.path("raw/000003.label"), {40, 50, 50, 50, 0});
  const std::string begin =
      "evaluate --prediction " + folder_.path("p") + label_set + " --row x ";
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

TEST_F(EvaluateTool, RefusesBadInput)
{
  const std::string one = "evaluate" + pair("1") + label_set;
  expectFails("evaluate" + pair("1"), 2, "label-set");
  expectFails(one + " --misspelt", 2, "misspelt");
  expectFails(one + " --ignore 12", 2, "'12'");
  expectFails(one + " --ignore skye", 2, "'skye'");
  expectFails(one + " --truth " + (folder_.path("t2")), 2, "given 2 and 1 times");
  expectFails("evaluate --prediction " + (folder_.path("p1")) + " --truth " +
                  (folder_.path("t2")) + label_set,
              3, "p1/000004.png: is missing");
  expectFails(one + " --covered-by " + (folder_.path("c2")), 3, "c2/000000.png");
  expectFails(one + " --output /dev/null/x", 5, "/dev/null/x");
  writeTextFile(folder_.path("p1/000000.png"), "no image");
  expectFails(one, 3, "p1/000000.png");
  writeImage(folder_.path("p1"), "000000.png", cv::Mat1b(2, 3, Label(12)));
  expectFails(one, 3, "label 12");
}

TEST(LidarTruthTool, ProjectsAGeneratedScan)
{
  const TemporaryFolder folder;
  const cv::Mat1b grey(40, 60, std::uint8_t(90));
  for (const char* camera : {"image_0/", "image_1/"})
    writeImage(folder.path(camera), "000002.png", grey);
  writeTextFile(folder.path("calib.txt"),
                "P0: 50 0 30 0 0 50 20 0 0 0 1 0\nP1: 50 0 30 -25 0 50 20 0 0 0 1 0\n"
                "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  fs::create_directories(folder.path("velodyne"));
  fs::create_directories(folder.path("labels"));
  const float points[] = {10, 2, 1, 0, 50, 0, 0, 0}; // the second is too far
  const std::uint32_t labels[] = {40 | 9u << 16, 40};
  std::ofstream(folder.path("velodyne/000002.bin"), std::ios::binary)
      .write(reinterpret_cast<const char*>(points), sizeof(points));
  std::ofstream(folder.path("labels/000002.label"), std::ios::binary)
      .write(reinterpret_cast<const char*>(labels), sizeof(labels));

  const std::string command = "lidar_truth " + folder.path() + label_set +
                              label_mapping + " --output " + (folder.path("truth"));
  succeed(command);
  const cv::Mat1b truth = readPng(folder.path("truth/000002.png"), ImageKind::labels);
  EXPECT_EQ(cv::countNonZero(truth), 1);
  EXPECT_EQ(truth(15, 20), 3);

  succeed(command + " --depth " + folder.path("depth") + " --scan-labels " +
          folder.path("points") + " --scan-depth " + folder.path("point_depth"));
  const cv::Mat1f depth = readDepths(folder.path("depth/000002.png"));
  EXPECT_EQ(cv::countNonZero(depth), 1);
  EXPECT_EQ(depth(15, 20), 10.0f);
  EXPECT_EQ(readScanLabels(folder.path("points/000002.label"), 11),
            (std::vector<Label>{3, 0}));
  const cv::Mat1f point_depth = readDepths(folder.path("point_depth/000002.bin"));
  EXPECT_EQ(point_depth(0, 0), 10.0f);
  EXPECT_EQ(point_depth(0, 1), 0.0f);
  expectFails(command + " --depth " + folder.path("truth"), 2, "are one folder");
  expectFails(command + " --scan-labels " + folder.path("labels"), 2,
              "holds files of the sequence");
  expectFails(command + "/../image_0", 2, "holds files of the sequence");
  expectFails(command + " --frames 10:5", 2, "10:5");
  expectFails(command + " --frames 3:5", 3, "3:5");
  expectFails(command + " --max-depth nan", 2, "max-depth");
  fs::resize_file(folder.path("labels/000002.label"), 7);
  fs::remove_all(folder.path("truth"));
  expectFails(command, 3, "000002.label: has 7 bytes");
  EXPECT_FALSE(fs::exists(folder.path("truth/000002.png")));
}

TEST(LidarTruthTool, AgreesWithTheHandMadeImage)
{
  const char* recordings = std::getenv("PCL_SEMANTIC_DATA");
  if (!recordings)
    GTEST_SKIP() << "skipped: PCL_SEMANTIC_DATA is not set";
  const TemporaryFolder folder;
  const std::string sequence = std::string(recordings) + "/kitti/05";
  succeed("lidar_truth " + sequence + label_set + label_mapping +
          " --frames 0:1 --output " + (folder.path("truth")));
  succeed("evaluate --prediction " + sequence + "/gt --truth " +
          (folder.path("truth")) + label_set + " --ignore sky,7,8,sidewalk --output " +
          (folder.path("out")));
  std::ifstream stream(folder.path("out/metrics.json"));
  const auto json = nlohmann::json::parse(stream);
  EXPECT_EQ(json["classes"][0]["name"], "building");
  EXPECT_GT(json["classes"][0]["iou_exclusive"], 0.9);
  EXPECT_EQ(json["classes"][1]["name"], "road");
  EXPECT_GT(json["classes"][1]["recall"], 0.99);
}

} // namespace pcl_semantic
