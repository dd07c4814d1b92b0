// SPDX-License-Identifier: BSD-3-Clause
#include "stereo/sgbm.h"
#include "support/same_image.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/image_file.h>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <cstdlib>

namespace pcl_semantic {
namespace {

constexpr int width = 320;
constexpr int height = 96;
constexpr int far_disparity = 9;
constexpr int near_disparity = 34;

struct Pair {
  cv::Mat left, right;
  cv::Mat disparity; // CV_32FC1, also where the match lies outside the right image
};

// A textured background and a nearer square in front of it.
Pair
makePair()
{
  cv::Mat texture(height, width + 64, CV_8UC1);
  cv::RNG random(7);
  random.fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, cv::Size(3, 3), 0.0);
  Pair pair{cv::Mat(height, width, CV_8UC1), cv::Mat(height, width, CV_8UC1),
            cv::Mat(height, width, CV_32FC1)};
  const auto near = [](int u, int v) {
    return u >= 150 && u < 230 && v >= 24 && v < 72;
  };
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const bool is_near = near(u, v);
      pair.left.at<std::uint8_t>(v, u) =
          texture.at<std::uint8_t>(is_near ? height - 1 - v : v, u);
      pair.disparity.at<float>(v, u) = is_near ? near_disparity : far_disparity;
      const bool right_near = near(u + near_disparity, v);
      pair.right.at<std::uint8_t>(v, u) =
          right_near ? texture.at<std::uint8_t>(height - 1 - v, u + near_disparity)
                     : texture.at<std::uint8_t>(v, u + far_disparity);
    }
  return pair;
}

Sgbm::Parameters
smallParameters()
{
  Sgbm::Parameters parameters;
  parameters.disparities = 64;
  return parameters;
}

TEST(Sgbm, FindsTheDisparitiesOfTwoPlanes)
{
  const Pair pair = makePair();
  for (const auto mode :
       {Sgbm::Mode::three_way, Sgbm::Mode::five_way, Sgbm::Mode::eight_way}) {
    Sgbm::Parameters parameters = smallParameters();
    parameters.mode = mode;
    const cv::Mat disparity =
        Sgbm(parameters).estimate(pair.left, pair.right).disparity;
    ASSERT_EQ(disparity.size(), pair.left.size());
    ASSERT_EQ(disparity.type(), CV_32FC1);
    int good = 0, wrong = 0;
    for (int v = 0; v < height; ++v)
      for (int u = 0; u < width; ++u) {
        const float d = disparity.at<float>(v, u);
        good += d > 0.0f && std::abs(d - pair.disparity.at<float>(v, u)) <= 0.5f;
        wrong += d > 0.0f && std::abs(d - pair.disparity.at<float>(v, u)) > 1.0f;
      }
    EXPECT_GT(good, 0.85 * width * height) << "mode " << int(mode);
    EXPECT_LT(wrong, 0.03 * width * height) << "mode " << int(mode);
  }
}

TEST(Sgbm, FirstColumnsHaveDepthWhereTheirMatchIsInTheRightImage)
{
  const Pair pair = makePair();
  const cv::Mat disparity =
      Sgbm(smallParameters()).estimate(pair.left, pair.right).disparity;
  int valid = 0;
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u)
      ASSERT_LE(disparity.at<float>(v, u), u) << "match outside, row " << v;
    for (int u = far_disparity + 3; u < 60; ++u)
      valid += std::abs(disparity.at<float>(v, u) - far_disparity) <= 0.5f;
  }
  EXPECT_GT(valid, 0.95 * height * (60 - far_disparity - 3));
}

TEST(Sgbm, ColourIsMatchedAsGrey)
{
  const Pair pair = makePair();
  cv::Mat left, right;
  cv::cvtColor(pair.left, left, cv::COLOR_GRAY2BGR);
  cv::cvtColor(pair.right, right, cv::COLOR_GRAY2BGR);
  Sgbm sgbm(smallParameters());
  EXPECT_TRUE(isSameImage(sgbm.estimate(pair.left, pair.right).disparity,
                          sgbm.estimate(left, right).disparity));
}

TEST(Sgbm, SameForAnyNumberOfThreads)
{
  const Pair pair = makePair();
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const cv::Mat single =
      Sgbm(smallParameters()).estimate(pair.left, pair.right).disparity;
  for (const int number : {2, 3, 8}) {
    cv::setNumThreads(number);
    EXPECT_TRUE(isSameImage(
        single, Sgbm(smallParameters()).estimate(pair.left, pair.right).disparity))
        << number << " threads";
  }
  cv::setNumThreads(threads);
}

TEST(Sgbm, ImagesSmallerThanTheSearchRange)
{
  for (const int size : {2, 3, 7}) {
    const cv::Mat image(size, size, CV_8UC1, cv::Scalar(100));
    EXPECT_EQ(Sgbm().estimate(image, image).disparity.size(), image.size());
  }
}

TEST(Sgbm, RefusesImagesThatDoNotFit)
{
  Sgbm sgbm;
  const cv::Mat grey(20, 30, CV_8UC1, cv::Scalar(0));
  EXPECT_THROW(sgbm.estimate(cv::Mat(), cv::Mat()), BadInputException);
  EXPECT_THROW(sgbm.estimate(grey, cv::Mat()), BadInputException);
  EXPECT_THROW(sgbm.estimate(grey, cv::Mat(20, 31, CV_8UC1)), BadInputException);
  EXPECT_THROW(sgbm.estimate(grey, cv::Mat(20, 30, CV_8UC3)), BadInputException);
  const cv::Mat deep(20, 30, CV_16UC1, cv::Scalar(0));
  EXPECT_THROW(sgbm.estimate(deep, deep), BadInputException);
}

TEST(Sgbm, RefusesParametersOutsideTheirRange)
{
  using P = Sgbm::Parameters;
  const auto expectRefused = [](int P::*member, std::initializer_list<int> values) {
    for (const int value : values) {
      P parameters;
      parameters.*member = value;
      EXPECT_THROW(Sgbm{parameters}, InvalidParameterException) << value;
    }
  };
  expectRefused(&P::disparities, {-16, 0, 8, 100, 1040});
  expectRefused(&P::block_size, {-1, 0, 4, 13});
  expectRefused(&P::small_step_penalty, {-1, 0, 64, 100});
  expectRefused(&P::large_step_penalty, {0, 16, 101});
  expectRefused(&P::uniqueness, {-1, 101});
  expectRefused(&P::gradient_cap, {0, 64});
  expectRefused(&P::speckle_size, {-1});
  expectRefused(&P::speckle_range, {-1, 100000});
}

TEST(Sgbm, MiddleburyCones)
{
  const char* const data = std::getenv("PCL_SEMANTIC_DATA");
  if (!data)
    GTEST_SKIP() << "skipped: PCL_SEMANTIC_DATA is not set";
  const std::string folder = std::string(data) + "/middlebury_cones/";
  const cv::Mat left = readPng(folder + "im2.png", ImageKind::grey_or_colour);
  const cv::Mat right = readPng(folder + "im6.png", ImageKind::grey_or_colour);
  const cv::Mat truth = readPng(folder + "disp2.png", ImageKind::labels);
  const cv::Mat disparity = Sgbm(smallParameters()).estimate(left, right).disparity;
  int known = 0, valid = 0, bad = 0;
  for (int v = 0; v < truth.rows; ++v)
    for (int u = 0; u < truth.cols; ++u) {
      const float t = truth.at<std::uint8_t>(v, u) / 4.0f;
      const float d = disparity.at<float>(v, u);
      known += t > 0.0f;
      valid += t > 0.0f && d > 0.0f;
      bad += t > 0.0f && d > 0.0f && std::abs(d - t) > 1.0f;
    }
  RecordProperty("valid_percent", 100 * valid / known);
  EXPECT_GT(valid, 0.85 * known);
  EXPECT_LT(bad, 0.07 * valid)
      << double(bad) / valid << " of " << double(valid) / known;
}

} // namespace
} // namespace pcl_semantic
