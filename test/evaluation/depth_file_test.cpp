// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/depth_file.h>
#include <pcl_semantic/images/image_file.h>

#include <opencv2/core.hpp>

#include <limits>

namespace pcl_semantic {

namespace {

std::string
floatBytes(const std::vector<float>& depths)
{
  return {reinterpret_cast<const char*>(depths.data()),
          depths.size() * sizeof(depths[0])};
}

} // namespace

TEST(DepthFile, ImagesAreKittis)
{
  const TemporaryFolder folder;
  const cv::Mat1f depth =
      (cv::Mat1f(2, 3) << 0.0f, 10.0f, 39.996f, 1.001f, 255.0f, 1000.0f);
  writeDepthImage(folder.path("a.png"), depth);
  const cv::Mat1w image = readPng(folder.path("a.png"), ImageKind::disparity);
  EXPECT_EQ(image(0, 1), 2560);
  const cv::Mat1f read = readDepths(folder.path("a.png"));
  ASSERT_EQ(read.size(), depth.size());
  for (int i = 0; i < 5; ++i)
    EXPECT_NEAR(read(i / 3, i % 3), depth(i / 3, i % 3), 0.5f / 256.0f);
  EXPECT_NEAR(read(1, 2), 256.0f, 0.01f); // as far as the format goes
}

TEST(DepthFile, NoMeasurementIsZero)
{
  constexpr float none = 0.0f, nan = std::numeric_limits<float>::quiet_NaN(),
                  inf = std::numeric_limits<float>::infinity();
  const TemporaryFolder folder;
  writePng(folder.path("a.png"), (cv::Mat1w(2, 2) << 0, 65535, 256, 65534));
  const cv::Mat1f image = readDepths(folder.path("a.png"));
  EXPECT_EQ(image(0, 0), none);
  EXPECT_EQ(image(0, 1), none);
  EXPECT_EQ(image(1, 0), 1.0f);
  EXPECT_GT(image(1, 1), 255.0f);
  folder.write("a.bin", floatBytes({0.0f, nan, inf, 2.0f}));
  const cv::Mat1f points = readDepths(folder.path("a.bin"));
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(points(0, i), none);
  EXPECT_EQ(points(0, 3), 2.0f);
}

TEST(DepthFile, OtherDepthsAreRefused)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("a.png");
  for (const cv::Mat& depths : {cv::Mat(4, 4, CV_16UC1, cv::Scalar(3000)),
                                cv::Mat(4, 4, CV_32FC3, cv::Scalar::all(3)),
                                cv::Mat(4, 4, CV_32FC1, cv::Scalar(-3)), cv::Mat()})
    expectBadParameter(path, [&] { writeDepthImage(path, depths); });
  writeDepthImage(path, cv::Mat(4, 4, CV_64FC1, cv::Scalar(3)));
  EXPECT_EQ(readDepths(path).at<float>(1, 1), 3.0f);
}

TEST(DepthFile, PointsAreFloats)
{
  const TemporaryFolder folder;
  folder.write("a.bin", floatBytes({0.0f, 12.3456f, 1000.0f}));
  const cv::Mat1f read = readDepths(folder.path("a.bin"));
  ASSERT_EQ(read.size(), cv::Size(3, 1));
  EXPECT_EQ(read(0, 1), 12.3456f);
  const auto refusal = [&] {
    return thrownMessage<BadInputException>([&] { readDepths(folder.path("a.bin")); });
  };
  for (const float bad : {-1.0f, -std::numeric_limits<float>::infinity()}) {
    folder.write("a.bin", floatBytes({1.0f, bad}));
    EXPECT_TRUE(holds(refusal(), "a.bin: point 1"));
  }
  folder.write("a.bin", "12345");
  EXPECT_TRUE(holds(refusal(), "has 5 bytes"));
  thrownMessage<BadInputException>([&] { readDepths(folder.path("none.png")); });
}

} // namespace pcl_semantic
