// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/labelling/network_description.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace pcl_semantic {
namespace {

namespace fs = std::filesystem;

class NetworkDescriptionTest : public ::testing::Test {
protected:
  void
  SetUp() override
  {
    const auto* const info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) / (std::string("network_") + info->name());
    fs::create_directories(folder_ / "sets");
    std::ofstream(folder_ / "sets/two.yaml") << "classes:\n"
                                                "  - {name: road, colour: [1, 2, 3]}\n"
                                                "  - {name: sky, colour: [4, 5, 6]}\n";
  }

  void
  TearDown() override
  {
    fs::remove_all(folder_);
  }

  // The description with one of its lines replaced.
  NetworkDescription
  read(std::size_t line = 0, const std::string& text = "")
  {
    std::vector<std::string> lines = lines_;
    if (line != 0)
      lines.at(line - 1) = text;
    std::ofstream file(folder_ / "net.yaml");
    for (const std::string& each : lines)
      file << each << "\n";
    file.close();
    return readNetworkDescription((folder_ / "net.yaml").string());
  }

  void
  expectRefused(std::size_t line, const std::string& text)
  {
    try {
      read(line, text);
      ADD_FAILURE() << "accepted: " << text;
    }
    catch (const BadInputException& error) {
      const std::string place = "net.yaml line " + std::to_string(line);
      EXPECT_NE(std::string(error.what()).find(place), std::string::npos)
          << error.what();
    }
  }

  fs::path folder_;
  std::vector<std::string> lines_ = {
      "model: net.onnx",
      "label_set: sets/two.yaml",
      "input: {name: image, width: 64, height: 32}",
      "output: {name: logits, softmax: false}",
      "mean: [0.1, 0.2, 0.3]",
      "deviation: [1, 2, 4]",
      "channels: [sky, '-', road, sky]",
  };
};

TEST_F(NetworkDescriptionTest, ReadsEverything)
{
  const NetworkDescription description = read();
  EXPECT_EQ(description.model_path, (folder_ / "net.onnx").string());
  EXPECT_EQ(description.label_set_path, (folder_ / "sets/two.yaml").string());
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
  expectRefused(1, "modle: net.onnx");
  expectRefused(3, "input: {name: image, width: 0, height: 32}");
  expectRefused(3, "input: {name: image, width: 64, height: 9000}");
  expectRefused(3, "input: {name: image, width: 64}");
  expectRefused(3, "input: {name: image, width: 64, height: 32, depth: 1}");
  expectRefused(4, "output: {name: logits, softmax: perhaps}");
  expectRefused(5, "mean: [0.1, 0.2]");
  expectRefused(5, "mean: [0.1, 0.2, .nan]");
  expectRefused(6, "deviation: [1, 0, 4]");
  expectRefused(7, "channels: [sky, tree]");
  expectRefused(7, "channels: []");
}

TEST_F(NetworkDescriptionTest, RefusesAMissingLabelSet)
{
  EXPECT_THROW(read(2, "label_set: sets/none.yaml"), BadInputException);
  EXPECT_THROW(read(2, ""), BadInputException);
}

TEST(NetworkDescriptionFiles, ShippedOnesAreReadable)
{
  int files = 0;
  for (const auto& entry : fs::directory_iterator(std::string(PCL_SEMANTIC_SOURCE_DIR) +
                                                  "/data/networks")) {
    const NetworkDescription description =
        readNetworkDescription(entry.path().string());
    EXPECT_FALSE(description.model_path.empty());
    ++files;
  }
  EXPECT_GT(files, 0);
}

} // namespace
} // namespace pcl_semantic
