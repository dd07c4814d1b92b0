// SPDX-License-Identifier: BSD-3-Clause
#include "support/full_disk.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/distribution_file.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/files/label_set_file.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <limits>

using namespace pcl_semantic;

namespace {

constexpr int width = 4;
constexpr int height = 3;
constexpr int classes = 5;
constexpr float confidence = 0.8f;

// Columns that sum to one exactly, so that nothing changes when they are normalised.
std::vector<float>
someValues()
{
  std::vector<float> values;
  for (int j = 0; j < width * height; ++j)
    for (int k = 0; k < classes; ++k)
      values.push_back(k == j % classes ? 0.5f : 0.125f);
  return values;
}

std::string
bytesOfFloats(const std::vector<float>& values)
{
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

std::string
npyOf(const std::vector<float>& values, const std::string& shape)
{
  std::string header =
      "{'descr': '<f4', 'fortran_order': False, 'shape': " + shape + ", }\n";
  return std::string("\x93NUMPY\x01\x00", 8) + char(header.size()) + '\0' + header +
         bytesOfFloats(values);
}

LabelDistributions
read(const std::string& path)
{
  return readDistributions(path, width, height, classes, confidence);
}

std::string
refusal(const std::vector<float>& values)
{
  const TemporaryFolder folder;
  const std::string path = folder.write("000000.bin", bytesOfFloats(values));
  const std::string message = thrownMessage<BadInputException>([&] { read(path); });
  EXPECT_TRUE(holds(message, path));
  return message;
}

} // namespace

TEST(ReadDistributions, BinAndNpyArePixelMajor)
{
  const TemporaryFolder folder;
  const std::vector<float> values = someValues();
  for (const std::string& path : {folder.write("a.bin", bytesOfFloats(values)),
                                  folder.write("a.npy", npyOf(values, "(3, 4, 5)"))}) {
    const LabelDistributions distributions = read(path);
    ASSERT_EQ(distributions.size(), width * height);
    ASSERT_EQ(distributions.classes(), classes);
    for (int j = 0; j < width * height; ++j)
      for (int k = 0; k < classes; ++k)
        EXPECT_EQ(distributions.matrix()(k, j), values[std::size_t(j * classes + k)]);
  }
}

TEST(ReadDistributions, ReadsWhatWriteDistributionsWrote)
{
  const TemporaryFolder folder;
  const LabelDistributions written =
      read(folder.write("a.bin", bytesOfFloats(someValues())));
  writeDistributions(folder.path("b.bin"), written);
  EXPECT_EQ(bytesOf(folder.path("b.bin")), bytesOf(folder.path("a.bin")));
}

TEST(ReadDistributions, ReadsWhatWasWrittenAsNpyAndAsIds)
{
  const TemporaryFolder folder;
  const LabelDistributions written =
      read(folder.write("a.bin", bytesOfFloats(someValues())));
  writeDistributions(folder.path("full.npy"), written, width, NpyType::float32);
  writeDistributions(folder.path("half.npy"), written, width, NpyType::float16);
  writeLabelIds(folder.path("ids.png"), written, width);
  // Powers of two are exact in both formats.
  EXPECT_EQ(read(folder.path("full.npy")).matrix(), written.matrix());
  EXPECT_EQ(read(folder.path("half.npy")).matrix(), written.matrix());
  const LabelDistributions ids = read(folder.path("ids.png"));
  ASSERT_EQ(ids.size(), written.size());
  for (Eigen::Index j = 0; j < ids.size(); ++j)
    EXPECT_EQ(ids.mapLabel(j), written.mapLabel(j));
  thrownMessage<InvalidParameterException>(
      [&] { writeLabelIds(folder.path("b.png"), written, width + 1); });
}

TEST(ReadDistributions, NumbersAndColoursOfImagesAreMapped)
{
  const TemporaryFolder folder;
  const LabelSet set({{"a", {10, 20, 30}}, {"b", {200, 0, 0}}, {"c", {0, 0, 200}}});
  const auto labels = [&](const std::string& mapping) {
    const LabelDistributions read = readDistributions(
        folder.path("a.png"), width, height, 3, 0.8f, readPixelMapping(mapping, set));
    EXPECT_NEAR(read.matrix().col(1).maxCoeff(), 0.8f, 1e-6f);
    return std::vector<int>{read.mapLabel(0), read.mapLabel(1), read.mapLabel(2),
                            read.mapLabel(3)};
  };
  const auto refusal = [&](const std::string& mapping) {
    return thrownMessage<BadInputException>([&] { labels(mapping); });
  };
  cv::Mat ids(height, width, CV_8UC1, cv::Scalar(0));
  ids.at<std::uint8_t>(0, 1) = 2;
  ids.at<std::uint8_t>(0, 2) = 7;
  writePng(folder.path("a.png"), ids);
  EXPECT_EQ(labels("zero_based"), (std::vector<int>{1, 3, 0, 1}));
  EXPECT_TRUE(holds(refusal("colours"), "is grey, expected the colours"));
  ids.convertTo(ids, CV_16UC1, 1000.0);
  writePng(folder.path("a.png"), ids);
  folder.write("m.yaml", "classes:\n  b: [2000]\n  a: [7000, 0]\n");
  EXPECT_EQ(labels(folder.path("m.yaml")), (std::vector<int>{1, 2, 1, 1}));
  cv::Mat colours(height, width, CV_8UC3, cv::Scalar(0, 0, 0));
  colours.at<cv::Vec3b>(0, 1) = {30, 20, 10}; // blue, green, red
  colours.at<cv::Vec3b>(0, 2) = {0, 0, 200};
  writePng(folder.path("a.png"), colours);
  EXPECT_EQ(labels("colours"), (std::vector<int>{0, 1, 2, 0}));
  EXPECT_TRUE(holds(refusal("zero_based"), "has 3 channel(s)"));
  colours.at<cv::Vec3b>(2, 3) = {0, 0, 100};
  writePng(folder.path("a.png"), colours);
  EXPECT_TRUE(holds(refusal("colours"), "pixel (3, 2) has the colour 100, 0, 0"));
  const LabelSet same({{"a", {1, 2, 3}}, {"b", {1, 2, 3}}});
  EXPECT_TRUE(holds(
      thrownMessage<BadInputException>([&] { readPixelMapping("colours", same); }),
      "'a' and 'b' of the label set have one colour"));
}

TEST(ReadDistributions, RefusesOtherSizes)
{
  const TemporaryFolder folder;
  const std::string whole = bytesOfFloats(someValues());
  for (const std::string& bytes :
       {whole.substr(1), whole + "x", whole + whole, std::string()}) {
    const std::string path = folder.write("a.bin", bytes);
    const std::string message = thrownMessage<BadInputException>([&] { read(path); });
    EXPECT_TRUE(holds(message, std::to_string(bytes.size())));
    EXPECT_TRUE(holds(message, "240"));
  }
  for (const char* const shape : {"(4, 3, 5)", "(3, 5, 4)", "(5, 3, 4)"}) {
    const std::string path = folder.write("a.npy", npyOf(someValues(), shape));
    EXPECT_TRUE(
        holds(thrownMessage<BadInputException>([&] { read(path); }), "(3, 4, 5)"));
  }
}

TEST(ReadDistributions, NamesThePixelOfABadValue)
{
  for (const float bad : {-0.01f, std::numeric_limits<float>::quiet_NaN(),
                          std::numeric_limits<float>::infinity()}) {
    std::vector<float> values = someValues();
    values[(2 * width + 1) * classes + 3] = bad;
    EXPECT_TRUE(holds(refusal(values), "(1, 2)"));
  }
}

TEST(ReadDistributions, NormalizesSumsNearOneAndRefusesOthers)
{
  std::vector<float> values = someValues();
  for (int k = 0; k < classes; ++k)
    values[k] *= 0.92f;
  const TemporaryFolder folder;
  const LabelDistributions distributions =
      read(folder.write("a.bin", bytesOfFloats(values)));
  EXPECT_NEAR(distributions.matrix()(0, 0), 0.5f, 1e-6);
  for (const float scale : {0.5f, 200.0f}) {
    values = someValues();
    for (int k = 0; k < classes; ++k)
      values[k] *= scale;
    EXPECT_TRUE(holds(refusal(values), "(0, 0)"));
  }
}

TEST(ReadDistributions, AZeroColumnIsUnlabelled)
{
  std::vector<float> values = someValues();
  std::fill_n(values.begin() + 7 * classes, classes, 0.0f);
  const TemporaryFolder folder;
  const LabelDistributions distributions =
      read(folder.write("a.bin", bytesOfFloats(values)));
  EXPECT_EQ(distributions.mapLabel(7), kUnlabelled);
  EXPECT_NE(distributions.mapLabel(8), kUnlabelled);
}

TEST(ReadDistributions, PngIdsGetTheStatedConfidence)
{
  const TemporaryFolder folder;
  cv::Mat ids(height, width, CV_8UC1, cv::Scalar(0));
  ids.at<std::uint8_t>(1, 2) = 5;
  writePng(folder.path("a.png"), ids);
  const LabelDistributions distributions = read(folder.path("a.png"));
  const int j = 1 * width + 2;
  EXPECT_NEAR(distributions.matrix()(4, j), 0.8f, 1e-6);
  EXPECT_NEAR(distributions.matrix()(0, j), 0.05f, 1e-6);
  EXPECT_EQ(distributions.mapLabel(0), kUnlabelled);
}

TEST(ReadDistributions, RefusesPngIdsBeyondTheClassesAndOtherSizes)
{
  const TemporaryFolder folder;
  cv::Mat ids(height, width, CV_8UC1, cv::Scalar(1));
  ids.at<std::uint8_t>(2, 3) = 6;
  writePng(folder.path("a.png"), ids);
  const std::string message =
      thrownMessage<BadInputException>([&] { read(folder.path("a.png")); });
  EXPECT_TRUE(holds(message, "(3, 2)"));
  EXPECT_TRUE(holds(message, "class 6"));
  writePng(folder.path("b.png"), cv::Mat(width, height, CV_8UC1, cv::Scalar(1)));
  EXPECT_TRUE(holds(
      thrownMessage<BadInputException>([&] { read(folder.path("b.png")); }), "3 x 4"));
}

TEST(ReadDistributions, RefusesOtherFilesAndMissingOnes)
{
  const TemporaryFolder folder;
  thrownMessage<BadInputException>([&] { read(folder.write("a.txt", "0.5")); });
  for (const char* const name : {"no.bin", "no.npy", "no.png"})
    EXPECT_TRUE(holds(
        thrownMessage<BadInputException>([&] { read(folder.path(name)); }), name));
}

TEST(WriteDistributions, LeavesNothingBehindWhenItFails)
{
  const TemporaryFolder folder;
  const FullDisk full(1000);
  thrownMessage<OutputException>(
      [&] { writeDistributions(folder.path("a.bin"), LabelDistributions(11, 10000)); });
  EXPECT_EQ(folder.entries(), 0u);
}
