// SPDX-License-Identifier: BSD-3-Clause
#include "stereo/disparity_cleaning.h"
#include "stereo/elas.h"
#include "stereo/kernels/map_disparity.h"
#include "support/same_image.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/image_file.h>

#include <gtest/gtest.h>
#include <omp.h>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>

namespace pcl_semantic {
namespace {

constexpr int width = 320;
constexpr int height = 120;

struct Pair {
  cv::Mat left, right;
  cv::Mat1f disparity; // also where the match lies outside the right image
};

cv::Mat
makeTexture(unsigned seed)
{
  cv::Mat texture(height, width + 128, CV_8UC1);
  cv::RNG(seed).fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, cv::Size(5, 5), 0.0);
  return texture;
}

// A surface whose disparity depends on the column of the right image and on the row.
Pair
makeSurface(const std::function<double(double u, int v)>& disparity)
{
  const cv::Mat texture = makeTexture(7);
  cv::Mat1f map_u(height, width), map_v(height, width);
  Pair pair{cv::Mat(texture, cv::Rect(0, 0, width, height)).clone(), cv::Mat(),
            cv::Mat1f(height, width)};
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      map_u(v, u) = float(u + disparity(u, v));
      map_v(v, u) = float(v);
      double d = disparity(u, v); // of a pixel of the left image: d = f(u - d)
      for (int i = 0; i < 30; ++i)
        d = disparity(u - d, v);
      pair.disparity(v, u) = float(d);
    }
  cv::remap(texture, pair.right, map_u, map_v, cv::INTER_CUBIC);
  return pair;
}

// A square in front of a background.
Pair
makeSquare()
{
  const cv::Mat back = makeTexture(7), front = makeTexture(8);
  const auto near = [](int u, int v) {
    return u >= 140 && u < 240 && v >= 30 && v < 90;
  };
  Pair pair{cv::Mat(height, width, CV_8UC1), cv::Mat(height, width, CV_8UC1),
            cv::Mat1f(height, width)};
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      pair.left.at<std::uint8_t>(v, u) =
          (near(u, v) ? front : back).at<std::uint8_t>(v, u);
      pair.disparity(v, u) = near(u, v) ? 34.0f : 9.0f;
      pair.right.at<std::uint8_t>(v, u) = near(u + 34, v)
                                              ? front.at<std::uint8_t>(v, u + 34)
                                              : back.at<std::uint8_t>(v, u + 9);
    }
  return pair;
}

TEST(Elas, FractionsOfSlantedPlanes)
{
  const std::function<double(double, int)> surfaces[] = {
      [](double, int) { return 12.3; }, [](double, int) { return 12.75; },
      [](double, int v) { return 8.0 + 0.2 * v; },
      [](double u, int) { return 10.0 + 0.05 * u; },
      [](double u, int v) { return 30.0 - 0.05 * u + 0.1 * v; }};
  for (const auto& surface : surfaces) {
    const Pair pair = makeSurface(surface);
    const cv::Mat1f found = Elas().estimate(pair.left, pair.right).disparity;
    int good = 0, count = 0;
    double bias = 0.0;
    for (int v = 5; v < height - 5; ++v)
      for (int u = 50; u < width - 60; ++u) {
        const double error = double(found(v, u) - pair.disparity(v, u));
        ++count;
        good += std::abs(error) <= 0.25;
        bias += error;
      }
    EXPECT_GT(good, 0.98 * count);
    EXPECT_NEAR(bias / count, 0.0, 0.05);
  }
}

TEST(Elas, ASquareHidesTheBackgroundBesideIt)
{
  const Pair pair = makeSquare();
  const DisparityImage found = Elas().estimate(pair.left, pair.right);
  int good = 0, hidden_good = 0;
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const bool right =
          std::abs(found.disparity.at<float>(v, u) - pair.disparity(v, u)) <= 0.5f;
      good += right;
      // The right camera sees the square there.
      hidden_good += u >= 118 && u < 136 && v >= 36 && v < 84 && right;
    }
  EXPECT_GT(good, 0.95 * width * height);
  EXPECT_GT(hidden_good, 0.9 * 18 * 48);
}

TEST(Elas, NothingIsLeftOutUnlessGapsStay)
{
  const Pair pair = makeSquare();
  EXPECT_EQ(cv::countNonZero(Elas().estimate(pair.left, pair.right).disparity),
            width * height);
  Elas::Parameters parameters;
  parameters.gap_width = 0;
  const DisparityImage found = Elas(parameters).estimate(pair.left, pair.right);
  int hidden = 0;
  for (int v = 36; v < 84; ++v)
    for (int u = 118; u < 136; ++u)
      hidden += found.disparity.at<float>(v, u) > 0.0f;
  EXPECT_LT(hidden, 0.1 * 48 * 18);
  EXPECT_GT(cv::countNonZero(found.disparity), 0.75 * width * height);
  EXPECT_TRUE(isSameImage(found.disparity > 0.0f, found.deviation > 0.0f));
}

TEST(Elas, WhatWasFilledIsLessSure)
{
  const Pair pair = makeSquare();
  const cv::Mat1f all = Elas().estimate(pair.left, pair.right).deviation;
  EXPECT_GT(all(60, 127), all(60, 190)); // hidden, matched
  EXPECT_GT(all(60, 190), 0.0f);
}

TEST(Elas, ABlankPairHasNoDisparity)
{
  const cv::Mat blank(height, width, CV_8UC1, cv::Scalar(90));
  const DisparityImage found = Elas().estimate(blank, blank);
  EXPECT_EQ(found.disparity.size(), blank.size());
  EXPECT_EQ(cv::countNonZero(found.disparity), 0);
  EXPECT_EQ(cv::countNonZero(found.deviation), 0);
}

TEST(Elas, ColourIsMatchedAsGrey)
{
  const Pair pair = makeSquare();
  cv::Mat left, right;
  cv::cvtColor(pair.left, left, cv::COLOR_GRAY2BGR);
  cv::cvtColor(pair.right, right, cv::COLOR_GRAY2BGR);
  Elas elas;
  EXPECT_TRUE(isSameImage(elas.estimate(pair.left, pair.right).disparity,
                          elas.estimate(left, right).disparity));
}

TEST(Elas, SameForAnyNumberOfThreads)
{
  const Pair pair = makeSquare();
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const DisparityImage single = Elas().estimate(pair.left, pair.right);
  for (const int number : {2, 3, 8}) {
    omp_set_num_threads(number);
    const DisparityImage found = Elas().estimate(pair.left, pair.right);
    EXPECT_TRUE(isSameImage(single.disparity, found.disparity)) << number << " threads";
    EXPECT_TRUE(isSameImage(single.deviation, found.deviation)) << number << " threads";
  }
  omp_set_num_threads(threads);
}

TEST(Elas, SmallImagesAndWideRanges)
{
  Elas::Parameters parameters;
  parameters.disparities = 1024;
  for (const int size : {1, 2, 3, 7, 23, 64}) {
    cv::Mat image(size, size + 3, CV_8UC1);
    cv::RNG(5).fill(image, cv::RNG::UNIFORM, 0, 256);
    EXPECT_EQ(Elas(parameters).estimate(image, image).disparity.size(), image.size());
  }
}

TEST(Elas, RefusesImagesThatDoNotFit)
{
  Elas elas;
  const cv::Mat grey(20, 30, CV_8UC1, cv::Scalar(0));
  EXPECT_THROW(elas.estimate(cv::Mat(), cv::Mat()), BadInputException);
  EXPECT_THROW(elas.estimate(grey, cv::Mat()), BadInputException);
  EXPECT_THROW(elas.estimate(grey, cv::Mat(20, 31, CV_8UC1)), BadInputException);
  EXPECT_THROW(elas.estimate(grey, cv::Mat(20, 30, CV_8UC3)), BadInputException);
  const cv::Mat wide(2, 16385, CV_8UC1, cv::Scalar(0));
  EXPECT_THROW(elas.estimate(wide, wide), BadInputException);
}

template <typename Value>
void
expectRefused(Value Elas::Parameters::*member, std::initializer_list<Value> values)
{
  for (const Value value : values) {
    Elas::Parameters parameters;
    parameters.*member = value;
    EXPECT_THROW(Elas{parameters}, InvalidParameterException) << value;
  }
}

TEST(Elas, RefusesParametersOutsideTheirRange)
{
  using P = Elas::Parameters;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expectRefused(&P::disparities, {-16, 0, 8, 100, 1040});
  expectRefused(&P::support_step, {0, 26});
  expectRefused(&P::support_texture, {-1, 128});
  expectRefused(&P::tau, {0.0, 1.1, nan});
  expectRefused(&P::support_tolerance, {-1.0, nan});
  expectRefused(&P::support_neighbours, {-1});
  expectRefused(&P::beta, {0.0, nan});
  expectRefused(&P::gamma, {0.0, nan});
  expectRefused(&P::sigma, {0.0, 1.5, nan});
  expectRefused(&P::left_right_tolerance, {-1.0, nan});
  expectRefused(&P::speckle_size, {-1});
  expectRefused(&P::speckle_range, {-1.0, nan});
  expectRefused(&P::smoothing_radius, {-1, 17});
  expectRefused(&P::smoothing_range, {-1.0, 51.0, nan});
  expectRefused(&P::gap_width, {-1});
  expectRefused(&P::gap_step, {-1.0, nan});
}

TEST(DisparityCleaning, SegmentsByTheirSize)
{
  // A spiral of one step per pixel (connected), and two single pixels.
  cv::Mat1s disparity(7, 9, kernels::no_disparity);
  const auto set = [&](int v, int u, int value) {
    disparity(v, u) = std::int16_t(value);
  };
  for (int u = 0; u < 9; ++u)
    set(0, u, 100 + u);
  for (int v = 1; v < 5; ++v)
    set(v, 8, 108 + v);
  for (int u = 7; u >= 2; --u)
    set(4, u, 112 + 8 - u);
  set(2, 4, 400);
  set(2, 5, 402); // two steps from its neighbour
  set(6, 0, 5);
  const cv::Mat1s before = disparity.clone();
  cv::Mat some = disparity.clone();
  removeSmallSegments(19, 1, some);
  for (int v = 0; v < 7; ++v)
    for (int u = 0; u < 9; ++u)
      EXPECT_EQ(some.at<std::int16_t>(v, u),
                (v == 2 && u < 8) || v == 6 ? kernels::no_disparity : before(v, u));
  removeSmallSegments(20, 1, some);
  EXPECT_EQ(cv::countNonZero(some != int(kernels::no_disparity)), 0);
  some = disparity.clone();
  removeSmallSegments(2, 2, some);
  EXPECT_EQ(some.at<std::int16_t>(2, 4), 400);
  EXPECT_EQ(some.at<std::int16_t>(6, 0), kernels::no_disparity);
}

TEST(DisparityCleaning, GapsAreFilledByTheRule)
{
  const std::int16_t n = kernels::no_disparity;
  const cv::Mat1s row = (cv::Mat1s(1, 12) << n, n, 160, n, n, n, 224, n, 64, n, n, n);
  const DisparityImage filled = fillGaps(3, 64, row);
  const float expected[] = {10, 10, 10, 11, 12, 13, 14, 4, 4, 4, 4, 4};
  for (int u = 0; u < 12; ++u)
    EXPECT_FLOAT_EQ(filled.disparity.at<float>(0, u), expected[u]) << u;
  const auto deviation = [&](int u) { return filled.deviation.at<float>(0, u); };
  EXPECT_LT(deviation(2), deviation(4)); // matched, between like ends
  EXPECT_LT(deviation(4), deviation(7)); // behind
  EXPECT_EQ(deviation(7), deviation(0));
  const DisparityImage shorter = fillGaps(2, 64, row);
  EXPECT_EQ(shorter.disparity.at<float>(0, 1), 10.0f);
  EXPECT_EQ(shorter.disparity.at<float>(0, 4), 0.0f);
  EXPECT_EQ(shorter.deviation.at<float>(0, 4), 0.0f);
  const cv::Mat1s nothing(1, 12, n);
  EXPECT_EQ(cv::countNonZero(fillGaps(99, 64, nothing).disparity), 0);
}

TEST(DisparityCleaning, SmoothingKeepsPlanesAndSteps)
{
  cv::Mat1s disparity(40, 60);
  for (int v = 0; v < 40; ++v)
    for (int u = 0; u < 60; ++u)
      disparity(v, u) = std::int16_t(u < 30 ? 800 + 4 * v - 2 * u : 300);
  cv::Mat smooth = disparity.clone();
  smoothDisparity(5, 64, smooth);
  for (int v = 5; v < 35; ++v)
    for (int u = 0; u < 60; ++u) {
      if (u < 5 || (u >= 25 && u < 30)) // less on one side
        continue;
      EXPECT_EQ(smooth.at<std::int16_t>(v, u), disparity(v, u)) << u << " " << v;
    }
}

TEST(Elas, MiddleburyCones)
{
  const char* const data = std::getenv("PCL_SEMANTIC_DATA");
  if (!data)
    GTEST_SKIP() << "skipped: PCL_SEMANTIC_DATA is not set";
  const std::string folder = std::string(data) + "/middlebury_cones/";
  const cv::Mat left = readPng(folder + "im2.png", ImageKind::grey_or_colour);
  const cv::Mat right = readPng(folder + "im6.png", ImageKind::grey_or_colour);
  const cv::Mat truth = readPng(folder + "disp2.png", ImageKind::labels);
  const cv::Mat disparity = Elas().estimate(left, right).disparity;
  int known = 0, bad = 0;
  for (int v = 0; v < truth.rows; ++v)
    for (int u = 0; u < truth.cols; ++u) {
      const float t = truth.at<std::uint8_t>(v, u) / 4.0f;
      known += t > 0.0f;
      bad += t > 0.0f && std::abs(disparity.at<float>(v, u) - t) > 1.0f;
    }
  EXPECT_LT(bad, 0.16 * known) << double(bad) / known;
}

} // namespace
} // namespace pcl_semantic
