// SPDX-License-Identifier: BSD-3-Clause
#include "stereo/disparity_cleaning.h"
#include "stereo/elas.h"
#include "stereo/kernels/smoothing.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <cstdlib>
#include <functional>

namespace pcl_semantic {
namespace {

constexpr int width = 320;
constexpr int height = 120;

struct Pair {
  cv::Mat left, right;
  cv::Mat1f disparity; // also where the match lies outside the right image
};

// A surface whose disparity depends on the column of the right image and on the row.
Pair
makeSurface(const std::function<double(double u, int v)>& disparity)
{
  cv::Mat texture(height, width + 128, CV_8UC1);
  cv::RNG(7).fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, cv::Size(5, 5), 0.0);
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

TEST(Elas, FractionsOfSlantedPlanes)
{
  const std::function<double(double, int)> surfaces[] = {
      [](double, int) { return 12.3; }, [](double, int) { return 12.75; },
      [](double, int v) { return 8.0 + 0.2 * v; },
      [](double u, int) { return 10.0 + 0.05 * u; },
      [](double u, int v) { return 30.0 - 0.05 * u + 0.1 * v; }};
  for (const auto& surface : surfaces) {
    const Pair pair = makeSurface(surface);
    const cv::Mat1f found = Elas(128).estimate(pair.left, pair.right).disparity;
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
  const DisparityImage filled = fillGaps(64, row);
  const float expected[] = {10, 10, 10, 11, 12, 13, 14, 4, 4, 4, 4, 4};
  for (int u = 0; u < 12; ++u)
    EXPECT_FLOAT_EQ(filled.disparity.at<float>(0, u), expected[u]) << u;
  const auto deviation = [&](int u) { return filled.deviation.at<float>(0, u); };
  EXPECT_LT(deviation(2), deviation(4)); // matched, between like ends
  EXPECT_LT(deviation(4), deviation(7)); // behind
  EXPECT_EQ(deviation(7), deviation(0));
  const cv::Mat1s nothing(1, 12, n);
  EXPECT_EQ(cv::countNonZero(fillGaps(64, nothing).disparity), 0);
}

TEST(DisparityCleaning, SmoothingKeepsPlanesAndSteps)
{
  cv::Mat1s disparity(40, 60);
  for (int v = 0; v < 40; ++v)
    for (int u = 0; u < 60; ++u)
      disparity(v, u) = std::int16_t(u < 30 ? 800 + 4 * v - 2 * u : 300);
  cv::Mat smooth = disparity.clone();
  smoothDisparity(smooth);
  for (int v = 5; v < 35; ++v)
    for (int u = 0; u < 60; ++u) {
      if (u < 5 || (u >= 25 && u < 30)) // less on one side
        continue;
      EXPECT_EQ(smooth.at<std::int16_t>(v, u), disparity(v, u)) << u << " " << v;
    }
}

} // namespace
} // namespace pcl_semantic
