// SPDX-License-Identifier: BSD-3-Clause
#include "support/bad_case.h"
#include "support/onnx_writer.h"
#include "support/same_image.h"

#include <pcl_semantic/files/input_file.h>

namespace pcl_semantic {

namespace {

// A network of four channels beside a street: net.yaml and net.onnx.
void
addNetwork(const std::string& street)
{
  PointwiseNetwork network;
  network.channels = 4;
  network.weights = {2, -1, 0.5f, -2, 1, 1, 0.25f, 0.5f, -3, 1, 1, 1};
  network.bias = {0.1f, -0.2f, 0.3f, -5.0f};
  std::ofstream(street + "/net.onnx", std::ios::binary) << network.file();
  std::ofstream(street + "/net.yaml")
      << "model: net.onnx\nlabel_set: " PCL_SEMANTIC_SOURCE_DIR
         "/data/label_sets/kitti11.yaml\ninput: {name: image, width: 8, height: 6}\n"
         "output: {name: logits, softmax: true}\nmean: [0.5, 0.5, 0.5]\n"
         "deviation: [0.2, 0.2, 0.2]\nchannels: [road, car, building, '-']\n";
}

const std::string tool = "label STREET --network STREET/net.yaml ";

} // namespace

TEST(LabelTool, AMapOfStoredLabelsIsThatOfTheNetwork)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street");
  copyStreet(street);
  addNetwork(street);
  const ToolResult labelled =
      runTool(replaceAll(tool, "STREET", street) + "--output " + folder.path("labels"));
  ASSERT_EQ(labelled.code, 0) << labelled.text;
  EXPECT_EQ(listFrameFiles(folder.path("labels"), {".npy"}).size(), 3u);
  for (const std::string& run :
       {" --labels " + folder.path("labels") + " --output " + folder.path("stored"),
        " --network " + street + "/net.yaml --output " + folder.path("direct")}) {
    const ToolResult mapped = runTool("map " + street + " --crf none" + run);
    ASSERT_EQ(mapped.code, 0) << mapped.text;
  }
  for (const char* image : {"network_labels/000001.png", "labels/000002.png"})
    EXPECT_TRUE(
        isSameImage(readPng(folder.path("stored/") + image, ImageKind::labels),
                    readPng(folder.path("direct/") + image, ImageKind::labels)));
}

TEST(LabelTool, IdsAreTheClassesOfTheDistributions)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street");
  copyStreet(street);
  addNetwork(street);
  for (const std::string format : {"float16", "ids"}) {
    const ToolResult labelled =
        runTool(replaceAll(tool, "STREET", street) + "--frames 1:2 --format " + format +
                " -o " + folder.path(format));
    ASSERT_EQ(labelled.code, 0) << labelled.text;
    const ToolResult mapped =
        runTool("map " + street + " --frames 1:2 --crf none --labels " +
                folder.path(format) + " --output " + folder.path("map_" + format));
    ASSERT_EQ(mapped.code, 0) << mapped.text;
  }
  const cv::Mat ids = readPng(folder.path("ids/000001.png"), ImageKind::labels);
  EXPECT_TRUE(isSameImage(ids, readPng(folder.path("map_ids/network_labels/000001.png"),
                                       ImageKind::labels)));
  // Rounding can only turn classes that are equally probable.
  const cv::Mat halves =
      readPng(folder.path("map_float16/network_labels/000001.png"), ImageKind::labels);
  EXPECT_LT(cv::countNonZero(ids != halves), int(ids.total() / 100));
  EXPECT_GT(cv::countNonZero(ids != ids.at<std::uint8_t>(0, 0)), 0);
}

TEST(LabelTool, BadInput)
{
  for (const BadCase& bad : std::vector<BadCase>{
           {"no sequence", 2, "the SEQUENCE is missing", "label"},
           {"no output", 2, "--output is missing", tool},
           {"no network", 2, "--network is missing", "label STREET --output OUT"},
           {"format", 2, "--format is 'jpg'", tool + "--format jpg --output OUT"},
           {"over the images", 2, "holds images",
            tool + "--format ids --output STREET/image_2"},
           {"beside others", 2, "where only .npy files",
            tool + "--output STREET/labels"},
           {"frames", 3, "has no frame in 7:9", tool + "--frames 7:9 --output OUT",
            addNetwork},
           {"no description", 3, "net.yaml", tool + "--output OUT"},
           {"no folder", 5, "cannot be made", tool + "--output STREET/calib.txt/out",
            addNetwork}})
    expectFails(bad);
}

} // namespace pcl_semantic
