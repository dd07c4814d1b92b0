// SPDX-License-Identifier: BSD-3-Clause
#include "support/refusal.h"
#include "support/temporary_folder.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/labelling/network_predictor.h>

#include <gtest/gtest.h>

#include <filesystem>

namespace pcl_semantic {
namespace {

class NetworkDescriptionTest : public ::testing::Test {
protected:
  NetworkDescriptionTest()
  {
    std::filesystem::create_directory(folder_.path("sets"));
    folder_.write("sets/two.yaml", "classes:\n"
                                   "  - {name: road, colour: [1, 2, 3]}\n"
                                   "  - {name: sky, colour: [4, 5, 6]}\n");
  }

  // The description with one of its lines replaced.
  NetworkDescription
  read(std::size_t line = 0, const std::string& text = "") const
  {
    std::vector<std::string> lines = {
        "model: net.onnx",
        "label_set: sets/two.yaml",
        "input: {name: image, width: 64, height: 32}",
        "output: {name: logits, softmax: false}",
        "mean: [0.1, 0.2, 0.3]",
        "deviation: [1, 2, 4]",
        "channels: [sky, '-', road, sky]",
    };
    if (line != 0)
      lines.at(line - 1) = text;
    std::string all;
    for (const std::string& each : lines)
      all += each + "\n";
    return readNetworkDescription(folder_.write("net.yaml", all));
  }

  TemporaryFolder folder_;
};

TEST_F(NetworkDescriptionTest, ReadsEverything)
{
  const NetworkDescription description = read();
  EXPECT_EQ(description.model_path, folder_.path("net.onnx"));
  EXPECT_EQ(description.label_set_path, folder_.path("sets/two.yaml"));
  EXPECT_EQ(description.input_name, "image");
  EXPECT_EQ(description.input_width, 64);
  EXPECT_EQ(description.input_height, 32);
  EXPECT_EQ(description.output_name, "logits");
  EXPECT_FALSE(description.softmax);
  EXPECT_EQ(description.mean, (std::array<float, 3>{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(description.deviation, (std::array<float, 3>{1.0f, 2.0f, 4.0f}));
  EXPECT_EQ(description.channels,
            (std::vector<std::string>{"sky", "-", "road", "sky"}));
}

TEST_F(NetworkDescriptionTest, ModelAndSoftmaxMayBeLeftOut)
{
  EXPECT_EQ(read(1, "# no model").model_path, "");
  EXPECT_TRUE(read(4, "output: {name: logits}").softmax);
}

TEST_F(NetworkDescriptionTest, RefusesWithTheLine)
{
  for (const auto& [line, text] : std::vector<std::pair<std::size_t, std::string>>{
           {1, "modle: net.onnx"},
           {3, "input: {name: image, width: 0, height: 32}"},
           {3, "input: {name: image, width: 64, height: 9000}"},
           {3, "input: {name: image, width: 64}"},
           {3, "input: {name: image, width: 64, height: 32, depth: 1}"},
           {4, "output: {name: logits, softmax: perhaps}"},
           {5, "mean: [0.1, 0.2]"},
           {5, "mean: [0.1, 0.2, .nan]"},
           {6, "deviation: [1, 0, 4]"},
           {7, "channels: [sky, tree]"},
           {7, "channels: []"}})
    expectRefusal<BadInputException>(
        "net.yaml line " + std::to_string(line),
        [&, number = line, &bad = text] { read(number, bad); });
}

TEST_F(NetworkDescriptionTest, RefusesAMissingLabelSet)
{
  EXPECT_THROW(read(2, "label_set: sets/none.yaml"), BadInputException);
  EXPECT_THROW(read(2, ""), BadInputException);
}

TEST(NetworkDescriptionFiles, ShippedOnesAreReadable)
{
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(
           std::string(PCL_SEMANTIC_SOURCE_DIR) + "/data/networks")) {
    EXPECT_FALSE(readNetworkDescription(entry.path().string()).model_path.empty());
    ++files;
  }
  EXPECT_GT(files, 0);
}

} // namespace
} // namespace pcl_semantic
