// SPDX-License-Identifier: BSD-3-Clause
#include "support/refused_file.h"

#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/images/distribution_file.h>
#include <pcl_semantic/images/image_file.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <cmath>
#include <filesystem>
#include <limits>

using namespace pcl_semantic;
namespace fs = std::filesystem;

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

LabelDistributions
readBin(const std::vector<float>& values)
{
  const TemporaryFolder folder;
  return read(folder.write("000000.bin", bytesOfFloats(values)));
}

::testing::AssertionResult
refuses(const std::string& name, const std::string& bytes, const std::string& part)
{
  return refusesFile(name, bytes, part, read);
}

} // namespace

TEST(ReadDistributions, BinAndNpyArePixelMajorAndComeBack)
{
  const TemporaryFolder folder;
  const std::vector<float> values = someValues();
  const LabelDistributions written = read(folder.write("a.bin", bytesOfFloats(values)));
  writeDistributions(folder.path("b.bin"), written);
  EXPECT_EQ(bytesOf(folder.path("b.bin")), bytesOf(folder.path("a.bin")));
  // Powers of two are exact in both formats.
  writeDistributions(folder.path("full.npy"), written, width, NpyType::float32);
  writeDistributions(folder.path("half.npy"), written, width, NpyType::float16);
  folder.write("a.npy", npyOf(values, "(3, 4, 5)"));
  for (const char* const name : {"a.bin", "a.npy", "full.npy", "half.npy"}) {
    const LabelDistributions distributions = read(folder.path(name));
    ASSERT_EQ(distributions.size(), width * height);
    ASSERT_EQ(distributions.classes(), classes);
    for (int j = 0; j < width * height; ++j)
      for (int k = 0; k < classes; ++k)
        EXPECT_EQ(distributions.matrix()(k, j), values[std::size_t(j * classes + k)]);
  }
}

TEST(ReadDistributions, PackedOnesComeBackNearly)
{
  const TemporaryFolder folder;
  const int many = 40, pixels = 1200;
  LabelDistributions written(many, pixels);
  for (int j = 0; j < pixels; ++j) {
    if (j % 100 == 0)
      continue;                    // unlabelled
    for (int k = 0; k < many; ++k) // most are much smaller than a step
      written.matrix()(k, j) = std::exp(-0.5f * float((k + many - j % many) % many));
    written.matrix().col(j) /= written.matrix().col(j).sum();
  }
  const std::string path = folder.path("000000.npy.zst");
  writeDistributions(path, written, 40, NpyType::uint8);
  EXPECT_LT(fs::file_size(path), std::size_t(pixels * 10));
  const auto read = [&](const std::string& file) {
    return readDistributions(file, 40, 30, many, confidence);
  };
  const LabelDistributions packed = read(path);
  EXPECT_LT((packed.matrix() - written.matrix()).cwiseAbs().maxCoeff(), 0.01f);
  for (int j = 0; j < pixels; ++j) {
    EXPECT_EQ(packed.mapLabel(j), written.mapLabel(j));
    EXPECT_NEAR(packed.matrix().col(j).sum(), j % 100 == 0 ? 0.0f : 1.0f, 1e-5f);
  }
  const std::string bytes = bytesOf(path);
  const auto expectRefused = [&](const std::string& content, const std::string& part) {
    EXPECT_TRUE(refusesFile("000001.npy.zst", content, part, read));
  };
  expectRefused("", "is no file of zstd");
  expectRefused("no zstd at all", "is no file of zstd");
  expectRefused(bytes.substr(0, bytes.size() / 2), "is damaged");
  EXPECT_TRUE(refusesFile("a.npy.zst", bytes, "bytes, expected at most",
                          [](const std::string& file) {
                            return readDistributions(file, 4, 3, 5, confidence);
                          }));
  EXPECT_TRUE(refusesFile("a.npy.zst", bytes, "has shape (30, 40, 40), expected",
                          [](const std::string& file) {
                            return readDistributions(file, 40, 30, 150, confidence);
                          }));
}

TEST(ReadDistributions, NumbersAndColoursOfImagesAreMapped)
{
  const TemporaryFolder folder;
  const LabelSet set({{"a", {10, 20, 30}}, {"b", {200, 0, 0}}, {"c", {0, 0, 200}}});
  const std::string path = folder.path("a.png");
  const auto labels = [&](const std::string& mapping) {
    const LabelDistributions read =
        readDistributions(path, width, height, 3, 0.8f, readPixelMapping(mapping, set));
    EXPECT_NEAR(read.matrix().col(1).maxCoeff(), 0.8f, 1e-6f);
    return std::vector<int>{read.mapLabel(0), read.mapLabel(1), read.mapLabel(2),
                            read.mapLabel(3)};
  };
  const auto refuses_mapping = [&](const std::string& mapping,
                                   const std::string& part) {
    return throws<BadInputException>(part, [&] { labels(mapping); });
  };
  cv::Mat ids(height, width, CV_8UC1, cv::Scalar(0));
  ids.at<std::uint8_t>(0, 1) = 2;
  ids.at<std::uint8_t>(0, 2) = 7;
  writePng(path, ids);
  EXPECT_EQ(labels("zero_based"), (std::vector<int>{1, 3, 0, 1}));
  EXPECT_TRUE(refuses_mapping("colours", "is grey, expected the colours"));
  ids.convertTo(ids, CV_16UC1, 1000.0);
  writePng(path, ids);
  folder.write("m.yaml", "classes:\n  b: [2000]\n  a: [7000, 0]\n");
  EXPECT_EQ(labels(folder.path("m.yaml")), (std::vector<int>{1, 2, 1, 1}));
  cv::Mat colours(height, width, CV_8UC3, cv::Scalar(0, 0, 0));
  colours.at<cv::Vec3b>(0, 1) = {30, 20, 10}; // blue, green, red
  colours.at<cv::Vec3b>(0, 2) = {0, 0, 200};
  writePng(path, colours);
  EXPECT_EQ(labels("colours"), (std::vector<int>{0, 1, 2, 0}));
  EXPECT_TRUE(refuses_mapping("zero_based", "has 3 channel(s)"));
  colours.at<cv::Vec3b>(2, 3) = {0, 0, 100};
  writePng(path, colours);
  EXPECT_TRUE(refuses_mapping("colours", "pixel (3, 2) has the colour 100, 0, 0"));
  const LabelSet same({{"a", {1, 2, 3}}, {"b", {1, 2, 3}}});
  expectBadInput("'a' and 'b' of the label set have the same colour",
                 [&] { readPixelMapping("colours", same); });
}

TEST(ReadDistributions, RefusesOtherSizesAndFiles)
{
  const std::string whole = bytesOfFloats(someValues());
  for (const std::string& bytes :
       {whole.substr(1), whole + "x", whole + whole, std::string()})
    EXPECT_TRUE(
        refuses("a.bin", bytes,
                "has " + std::to_string(bytes.size()) + " bytes, expected 240"));
  for (const char* const shape : {"(4, 3, 5)", "(3, 5, 4)", "(5, 3, 4)"})
    EXPECT_TRUE(refuses("a.npy", npyOf(someValues(), shape), "(3, 4, 5)"));
  EXPECT_TRUE(refuses("a.txt", "0.5", ".bin, .npy, .npy.zst or .png"));
  for (const char* const name : {"/no.bin", "/no.npy", "/no.png"})
    expectBadInput(name, [&] { read(name); });
}

TEST(ReadDistributions, NormalizesSumsNearOneAndRefusesOthers)
{
  const auto scaled = [](float scale) {
    std::vector<float> values = someValues();
    for (int k = 0; k < classes; ++k)
      values[std::size_t(k)] *= scale;
    return values;
  };
  EXPECT_NEAR(readBin(scaled(0.92f)).matrix()(0, 0), 0.5f, 1e-6);
  for (const float scale : {0.5f, 200.0f})
    EXPECT_TRUE(refuses("a.bin", bytesOfFloats(scaled(scale)), "(0, 0)"));
  for (const float bad : {-0.01f, std::numeric_limits<float>::quiet_NaN(),
                          std::numeric_limits<float>::infinity()}) {
    std::vector<float> values = someValues();
    values[(2 * width + 1) * classes + 3] = bad;
    EXPECT_TRUE(refuses("a.bin", bytesOfFloats(values), "(1, 2)"));
  }
  const LabelDistributions unlabelled = readBin(scaled(0.0f));
  EXPECT_EQ(unlabelled.mapLabel(0), kUnlabelled);
  EXPECT_NE(unlabelled.mapLabel(1), kUnlabelled);
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
  // The file contains the most probable classes.
  writeLabelIds(folder.path("b.png"), distributions, width);
  EXPECT_EQ(read(folder.path("b.png")).matrix(), distributions.matrix());
  thrownMessage<InvalidParameterException>(
      [&] { writeLabelIds(folder.path("c.png"), distributions, width + 1); });

  ids.at<std::uint8_t>(2, 3) = 6;
  writePng(folder.path("a.png"), ids);
  expectBadInput("(3, 2) has class 6", [&] { read(folder.path("a.png")); });
  writePng(folder.path("b.png"), cv::Mat(width, height, CV_8UC1, cv::Scalar(1)));
  expectBadInput("3 x 4", [&] { read(folder.path("b.png")); });
}
