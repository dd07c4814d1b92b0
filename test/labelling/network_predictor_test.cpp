// SPDX-License-Identifier: BSD-3-Clause
#include "support/onnx_writer.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/labelling/network_predictor.h>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>

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

TEST_F(NetworkDescriptionTest, ModelAndSoftmaxMayBeLeftOutAndInputsHaveALimit)
{
  EXPECT_EQ(read(1, "# no model").model_path, "");
  EXPECT_TRUE(read(4, "output: {name: logits}").softmax);
  EXPECT_EQ(read(3, "input: {name: image, width: 8192, height: 1}").input_width, 8192);
  expectBadInput("width is 8193, expected 1 to 8192",
                 [&] { read(3, "input: {name: image, width: 8193, height: 1}"); });
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
    expectBadInput("net.yaml line " + std::to_string(line),
                   [&, number = line, &bad = text] { read(number, bad); });
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

const LabelSet label_set({{"road", {}, false, false},
                          {"sky", {}, true, false},
                          {"car", {}, false, true}});

// By every engine that there is.
class NetworkPredictorTest : public ::testing::TestWithParam<NetworkEngine> {
protected:
  NetworkPredictorTest()
  {
    network_.weights = {2, -1, 0.5f, -2, 1, 1, 0.25f, 0.5f, -3, 1, 1, 1};
    network_.bias = {0.1f, -0.2f, 0.3f, 1.5f};
    description_.input_name = "image";
    description_.input_width = network_.width;
    description_.input_height = network_.height;
    description_.output_name = "logits";
    description_.mean = {0.4f, 0.5f, 0.6f};
    description_.deviation = {0.2f, 0.3f, 0.4f};
    description_.channels = {"car", "road", "car", "-"};
    image_.create(15, 21, CV_8UC3);
    cv::RNG(9).fill(image_, cv::RNG::UNIFORM, 0, 256);
  }

  LabelDistributions
  predict(const std::string& content) const
  {
    const std::string path = folder_.write("net.onnx", content);
    return NetworkPredictor(description_, label_set, path, GetParam())
        .predict(image_, number_);
  }

  // The message names the file or, after loading, the frame.
  void
  expectRefused(const std::string& content, const std::string& named) const
  {
    expectRefusal<BadModelException>(named, [&] { predict(content); });
  }

  // Logits of one pixel of the resized image: the 1 x 1 convolution in double
  // precision.
  double
  logit(int channel, const cv::Vec3b& bgr) const
  {
    double sum = network_.bias[channel];
    for (int k = 0; k < 3; ++k)
      sum += network_.weights[3 * channel + k] *
             (bgr[2 - k] / 255.0 - description_.mean[k]) / description_.deviation[k];
    return sum;
  }

  // Computes distributions with distributionsFromLogits(), which is tested separately.
  LabelDistributions
  plain(const cv::Mat& image) const
  {
    cv::Mat resized;
    cv::resize(image, resized, cv::Size(network_.width, network_.height));
    const int shape[] = {network_.channels, network_.height, network_.width};
    cv::Mat logits(3, shape, CV_32FC1);
    for (int c = 0; c < network_.channels; ++c)
      for (int v = 0; v < resized.rows; ++v)
        for (int u = 0; u < resized.cols; ++u)
          logits.at<float>(c, v, u) = float(logit(c, resized.at<cv::Vec3b>(v, u)));
    return distributionsFromLogits(logits, image.size(), {{3, 1, 3, 0}, 3, true});
  }

  const TemporaryFolder folder_;
  const std::string path_ = folder_.path("net.onnx");
  PointwiseNetwork network_;
  NetworkDescription description_;
  cv::Mat image_;
  int number_ = 42;
};

TEST_P(NetworkPredictorTest, EqualsThePlainComputation)
{
  const LabelDistributions labels = predict(network_.file());
  const Eigen::MatrixXf expected = plain(image_).matrix();
  ASSERT_EQ(labels.classes(), 3);
  ASSERT_EQ(labels.size(), image_.size().area());
  EXPECT_LT((labels.matrix() - expected).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_TRUE((labels.matrix().row(1).array() == 0.0f).all()) << "no channel is sky";
  const auto empty = (expected.colwise().sum().array() == 0.0f).count();
  EXPECT_GT(empty, 0) << "both sides of the half-left rule are tried";
  EXPECT_LT(empty, expected.cols() / 2);
}

TEST_P(NetworkPredictorTest, GreyImageIsAColourImageOfEqualChannels)
{
  cv::Mat grey, colour;
  cv::cvtColor(image_, grey, cv::COLOR_BGR2GRAY);
  cv::cvtColor(grey, colour, cv::COLOR_GRAY2BGR);
  image_ = grey;
  const LabelDistributions from_grey = predict(network_.file());
  image_ = colour;
  EXPECT_EQ(from_grey.matrix(), predict(network_.file()).matrix());
}

TEST_P(NetworkPredictorTest, RefusesFilesThatAreNoNetworkThatItKnows)
{
  expectRefused("no network", path_);
  EXPECT_THROW(NetworkPredictor(description_, label_set, path_ + ".none", GetParam()),
               BadInputException);
  std::string content = network_.file();
  content.replace(content.find("Conv"), 4, "Vonc");
  expectRefused(content, path_);
  // An engine would run functions unchecked.
  expectRefused(network_.file() + Message().bytes(25, "").text(),
                "has functions of its own");
}

TEST_P(NetworkPredictorTest, RefusesTensorsThatAnEngineWouldReadBeyond)
{
  const auto bias = floatTensor("bias", {4}, network_.bias);
  for (const std::uint64_t dim :
       {std::uint64_t(5), std::uint64_t(1) << 28, std::uint64_t(1) << 40})
    expectRefused(network_.withTensors(
                      floatTensor("weights", {dim, 3, 1, 1}, network_.weights), bias),
                  path_);
}

TEST_P(NetworkPredictorTest, RefusesAnotherInputOrOutput)
{
  description_.output_name = "probabilities";
  expectRefused(network_.file(), "has no output 'probabilities', which its description "
                                 "names; its outputs are 'logits'");
  description_.output_name = "logits";
  description_.input_name = "picture";
  expectRefused(network_.file(), "has no input 'picture', which its description names; "
                                 "its inputs are 'image'");
}

TEST_P(NetworkPredictorTest, SaysForWhatSizeANetworkThatFailsWasExported)
{
  const Message add =
      Message().bytes(1, "image").bytes(1, "offset").bytes(2, "logits").bytes(4, "Add");
  const auto file = [&](std::uint64_t rows, std::uint64_t columns) {
    const std::vector<std::uint64_t> size = {1, 3, rows, columns};
    return onnxModel(
        Message()
            .message(1, add)
            .bytes(2, "graph")
            .message(5, floatTensor("offset", size,
                                    std::vector<float>(3 * rows * columns, 1.0f)))
            .message(11, floatValue("image", size))
            .message(12, floatValue("logits", size)));
  };
  description_.input_width = 16;
  expectRefused(file(6, 8),
                "exported for images of 8 x 6, its description says 16 x 6");
  description_.input_height = 2;
  expectRefused(file(1, 8),
                "exported for images of 8 x 1, its description says 16 x 2");
}

TEST_P(NetworkPredictorTest, RefusesAnswersThatAreNoProbabilities)
{
  description_.channels.push_back("sky"); // one too many
  expectRefused(network_.file(), "frame 42");
  description_.channels.pop_back();
  description_.softmax = false; // some are negative
  expectRefused(network_.file(), "frame 42");
  description_.softmax = true;
  for (const float value : {std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity()}) {
    network_.bias[2] = value;
    expectRefused(network_.file(), "frame 42");
  }
}

TEST_P(NetworkPredictorTest, RefusesImagesOfOtherTypes)
{
  folder_.write("net.onnx", network_.file());
  NetworkPredictor predictor(description_, label_set, path_, GetParam());
  for (const cv::Mat& image :
       {cv::Mat(), cv::Mat(4, 4, CV_16UC1), cv::Mat(4, 4, CV_8UC4)}) {
    image_ = image;
    EXPECT_THROW(predictor.predict(image_, number_), BadInputException);
  }
}

TEST_P(NetworkPredictorTest, TakesTheModelOfTheDescriptionAndItsClassesIfThereAreSome)
{
  folder_.write("net.onnx", network_.file());
  description_.model_path = path_;
  EXPECT_NO_THROW(NetworkPredictor(description_, label_set, "", GetParam())
                      .predict(image_, number_));
  description_.channels[1] = "tram";
  EXPECT_THROW(NetworkPredictor(description_, label_set, path_, GetParam()),
               InvalidParameterException);
}

TEST_P(NetworkPredictorTest, RefusesAnEngineThatIsNotThere)
{
  if (networkEngines().size() > 1)
    GTEST_SKIP() << "skipped: all engines are there";
  expectBadParameter("built without ONNX Runtime", [&] {
    NetworkPredictor(description_, label_set, path_, NetworkEngine::onnx_runtime);
  });
}

INSTANTIATE_TEST_SUITE_P(Engines, NetworkPredictorTest,
                         testing::ValuesIn(networkEngines()));

// The street of KITTI sequence 15 against labels made by hand: 88 % of the pixels are
// right; the network takes the pavement for road.
class NetworkPredictorData : public testing::TestWithParam<NetworkEngine> {};

TEST_P(NetworkPredictorData, KittiStreet)
{
  const char* const data = std::getenv("PCL_SEMANTIC_DATA");
  if (!data)
    GTEST_SKIP() << "skipped: PCL_SEMANTIC_DATA is not set";
  const std::string root = data;
  const NetworkDescription description =
      readNetworkDescription(std::string(PCL_SEMANTIC_SOURCE_DIR) +
                             "/data/networks/espnetv2_city_1280x480.yaml");
  const LabelSet classes = readLabelSet(description.label_set_path);
  const std::string model = root + "/nets/espnetv2_s2.0_city_1280x480_halfres.onnx";
  NetworkPredictor predictor(description, classes, model, GetParam());
  const cv::Mat image =
      readPng(root + "/kitti/15/image_2/000000.png", ImageKind::grey_or_colour);
  const LabelDistributions labels = predictor.predict(image, 0);
  const cv::Mat truth = readPng(root + "/kitti/15/gt/000000.png", ImageKind::labels);
  ASSERT_EQ(labels.size(), Eigen::Index(truth.total()));

  const Label road = classes.find("road");
  int known = 0, right = 0, roads = 0, right_roads = 0;
  for (int j = 0; j < int(truth.total()); ++j) {
    const Label expected = truth.ptr(j / truth.cols)[j % truth.cols];
    const bool equal = labels.mapLabel(j) == expected;
    known += expected != kUnlabelled;
    right += expected != kUnlabelled && equal;
    roads += expected == road;
    right_roads += expected == road && equal;
  }
  EXPECT_GT(right, 0.86 * known) << right << " of " << known;
  EXPECT_GT(right_roads, 0.97 * roads) << right_roads << " of " << roads;

  const ThreadScope one(1);
  EXPECT_EQ(predictor.predict(image, 0).matrix(), labels.matrix()) << "one thread";
  EXPECT_EQ(NetworkPredictor(description, classes, model, GetParam())
                .predict(image, 0)
                .matrix(),
            labels.matrix())
      << "loaded with one thread";
}

INSTANTIATE_TEST_SUITE_P(Engines, NetworkPredictorData,
                         testing::ValuesIn(networkEngines()));

// Of each network, the classes of pixels that any two engines see in an image.
TEST(NetworkEngines, SeeTheSame)
{
  const char* const data = std::getenv("PCL_SEMANTIC_DATA");
  if (!data || networkEngines().size() < 2)
    GTEST_SKIP() << "skipped: PCL_SEMANTIC_DATA is not set, or there is one engine";
  const std::string root = data;
  NetworkDescription description =
      readNetworkDescription(std::string(PCL_SEMANTIC_SOURCE_DIR) +
                             "/data/networks/espnetv2_city_1280x480.yaml");
  const LabelSet classes = readLabelSet(description.label_set_path);
  const cv::Mat image =
      readPng(root + "/kitti/15/image_2/000000.png", ImageKind::grey_or_colour);
  for (const auto& [name, size] : std::map<std::string, cv::Size>{
           {"espnetv2_s1.0_city_1120x320_halfres", {1120, 320}},
           {"espnetv2_s2.0_city_1120x320_halfres", {1120, 320}},
           {"espnetv2_s2.0_city_1280x480_halfres", {1280, 480}}}) {
    description.input_width = size.width;
    description.input_height = size.height;
    std::vector<LabelDistributions> labels;
    for (const NetworkEngine engine : networkEngines())
      labels.push_back(NetworkPredictor(description, classes,
                                        root + "/nets/" + name + ".onnx", engine)
                           .predict(image, 0));
    int equal = 0;
    for (Eigen::Index j = 0; j < labels[0].size(); ++j)
      equal += labels[0].mapLabel(j) == labels[1].mapLabel(j);
    EXPECT_GE(equal, 0.999 * double(labels[0].size())) << name;
  }
}

} // namespace
} // namespace pcl_semantic
