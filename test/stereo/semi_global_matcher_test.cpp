// SPDX-License-Identifier: BSD-3-Clause
#include "stereo/kernels/map_disparity.h"
#include "stereo/semi_global_band.h"
#include "support/supported_tiers.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <bitset>
#include <cmath>

namespace pcl_semantic {
namespace {

struct Pair {
  cv::Mat left, right;
};

// A texture; the right image sees it by 7 px to the left, and a part of it by 23 px.
Pair
makePair(int width, int height, unsigned seed)
{
  cv::Mat texture(height, width + 64, CV_8UC1);
  cv::RNG random(seed);
  random.fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, cv::Size(3, 3), 0.0);
  Pair pair{texture.colRange(0, width).clone(), cv::Mat(height, width, CV_8UC1)};
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const bool is_near = u > width / 3 && u < width / 2 && v > height / 4;
      const int noise = random.uniform(-3, 4);
      pair.right.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(
          texture.at<std::uint8_t>(v, u + (is_near ? 23 : 7)) + noise);
    }
  return pair;
}

// The matcher as its description says, one pixel and disparity at a time.
class PlainMatcher {
public:
  PlainMatcher(const Pair& pair, const SemiGlobalMatcher::Parameters& parameters)
      : pair_(pair), parameters_(parameters), width_(pair.left.cols),
        height_(pair.left.rows), D_(parameters.disparities),
        left_(censusesOf(pair.left)), right_(censusesOf(pair.right))
  {}

  // Disparities of the rows from begin to end; paths from above begin at row first.
  cv::Mat
  match(int first, int begin, int end) const
  {
    cv::Mat result(height_, width_, CV_16SC1, cv::Scalar(kernels::no_disparity));
    Row above(std::size_t(width_), Costs(std::size_t(D_), 0));
    for (int v = first; v < end; ++v) {
      Row costs, sums;
      for (int u = 0; u < width_; ++u)
        costs.push_back(costsAt(u, v));
      sums.assign(std::size_t(width_), Costs(std::size_t(D_), 0));
      for (int u = 0; u < width_; ++u) {
        above[std::size_t(u)] = next(above[std::size_t(u)], costs[std::size_t(u)],
                                     largeStep(u, v, u, v - 1));
        add(above[std::size_t(u)], sums[std::size_t(u)]);
      }
      Costs path(std::size_t(D_), 0);
      for (int u = 0; u < width_; ++u) {
        path = next(path, costs[std::size_t(u)], largeStep(u, v, u - 1, v));
        add(path, sums[std::size_t(u)]);
      }
      path.assign(std::size_t(D_), 0);
      for (int u = width_ - 1; u >= 0; --u) {
        path = next(path, costs[std::size_t(u)], largeStep(u, v, u + 1, v));
        add(path, sums[std::size_t(u)]);
      }
      if (v >= begin)
        for (int u = 0; u < width_; ++u)
          result.at<std::int16_t>(v, u) = choose(sums, u);
    }
    return result;
  }

private:
  using Costs = std::vector<int>;
  using Row = std::vector<Costs>;

  static int
  greyAt(const cv::Mat& image, int u, int v)
  {
    return image.at<std::uint8_t>(std::clamp(v, 0, image.rows - 1),
                                  std::clamp(u, 0, image.cols - 1));
  }

  static std::bitset<64>
  censusAt(const cv::Mat& image, int u, int v)
  {
    std::bitset<64> census;
    for (int dy = -3, bit = 0; dy <= 3; ++dy)
      for (int dx = -4; dx <= 4; ++dx)
        if ((dx + dy) % 2 != 0)
          census[std::size_t(bit++)] =
              greyAt(image, u + dx, v + dy) < greyAt(image, u, v);
    return census;
  }

  static std::vector<std::bitset<64>>
  censusesOf(const cv::Mat& image)
  {
    std::vector<std::bitset<64>> all;
    for (int v = 0; v < image.rows; ++v)
      for (int u = 0; u < image.cols; ++u)
        all.push_back(censusAt(image, u, v));
    return all;
  }

  int
  quarterAt(int u, int v, int d) const
  {
    u = std::clamp(u, 0, width_ - 1);
    std::size_t sum = 0;
    for (int dy = -2; dy <= 2; ++dy) {
      const int y = std::clamp(v + dy, 0, height_ - 1);
      sum += (left_[std::size_t(y * width_ + u)] ^
              right_[std::size_t(y * width_ + std::max(u - d, 0))])
                 .count();
    }
    return int(sum + 2) / 4;
  }

  Costs
  costsAt(int u, int v) const
  {
    Costs costs;
    for (int d = 0; d < D_; ++d) {
      int sum = 0;
      for (int dx = -2; dx <= 2; ++dx)
        sum += quarterAt(u + dx, v, d);
      costs.push_back((sum + 2) / 4);
    }
    return costs;
  }

  int
  largeStep(int u, int v, int from_u, int from_v) const
  {
    const int difference =
        std::abs(greyAt(pair_.left, u, v) - greyAt(pair_.left, from_u, from_v));
    return std::max(parameters_.small_step + 1,
                    parameters_.large_step * parameters_.edge /
                        std::max(parameters_.edge, difference));
  }

  Costs
  next(const Costs& before, const Costs& costs, int large_step) const
  {
    const int smallest = *std::min_element(before.begin(), before.end());
    Costs path(costs.size());
    for (std::size_t d = 0; d < costs.size(); ++d) {
      int best = std::min(before[d], smallest + large_step);
      if (d > 0)
        best = std::min(best, before[d - 1] + parameters_.small_step);
      if (d + 1 < costs.size())
        best = std::min(best, before[d + 1] + parameters_.small_step);
      path[d] = costs[d] + best - smallest;
    }
    return path;
  }

  static void
  add(const Costs& path, Costs& sums)
  {
    for (std::size_t d = 0; d < path.size(); ++d)
      sums[d] += path[d];
  }

  std::int16_t
  choose(const Row& sums, int u) const
  {
    const Costs& own = sums[std::size_t(u)];
    const int d = int(std::min_element(own.begin(), own.end()) - own.begin());
    const int smallest = own[std::size_t(d)];
    if (d > u)
      return kernels::no_disparity;
    const int limit =
        int(float(smallest) * (100.0f / float(100 - parameters_.uniqueness)));
    for (int other = 0; other < D_; ++other)
      if (std::abs(other - d) > 1 && own[std::size_t(other)] <= limit)
        return kernels::no_disparity;
    // The best match of the pixel in the right image; of several the farthest right.
    int theirs = 0, least = 1 << 30;
    for (int e = D_ - 1; e >= 0; --e)
      if (u - d + e < width_ && sums[std::size_t(u - d + e)][std::size_t(e)] < least) {
        least = sums[std::size_t(u - d + e)][std::size_t(e)];
        theirs = e;
      }
    if (std::abs(theirs - d) > parameters_.left_right_tolerance)
      return kernels::no_disparity;
    double shift = 0.0;
    if (d > 0 && d + 1 < D_) {
      const int before = own[std::size_t(d - 1)] - smallest;
      const int behind = own[std::size_t(d + 1)] - smallest;
      shift = 0.5 * (before - behind) / std::max({before, behind, 1});
    }
    return std::int16_t(std::lround((d + shift) * kernels::disparity_steps));
  }

  const Pair& pair_;
  const SemiGlobalMatcher::Parameters& parameters_;
  int width_, height_, D_;
  std::vector<std::bitset<64>> left_, right_; // censuses
};

int
differences(const cv::Mat& a, const cv::Mat& b)
{
  return cv::countNonZero(a != b);
}

TEST(SemiGlobalMatcher, EqualsAPlainOneInEveryTier)
{
  SemiGlobalMatcher::Parameters parameters;
  for (const int disparities : {64, 128}) {
    parameters.disparities = disparities;
    const Pair pair = makePair(101, 40, unsigned(disparities));
    const CensusImage left(pair.left, CensusImage::Order::forwards, 0);
    const CensusImage right(pair.right, CensusImage::Order::backwards,
                            disparities + kernels::disparity_block);
    const PlainMatcher plain(pair, parameters);
    // A band at the top, and one that begins 16 rows above its first row.
    const cv::Mat top = plain.match(0, 0, 12), below = plain.match(8, 24, 40);
    EXPECT_GT(cv::countNonZero(top >= 0), 300);
    EXPECT_GT(cv::countNonZero(below >= 0), 500);
    for (const SimdTier tier : supportedTiers()) {
      SemiGlobalBand band({pair.left, left, right}, parameters, tier);
      cv::Mat disparity(pair.left.size(), CV_16SC1);
      band.match(24, 40, disparity);
      EXPECT_EQ(differences(disparity.rowRange(24, 40), below.rowRange(24, 40)), 0)
          << nameOf(tier);
      band.match(0, 12, disparity); // nothing is left of the band before
      EXPECT_EQ(differences(disparity.rowRange(0, 12), top.rowRange(0, 12)), 0)
          << nameOf(tier);
    }
  }
}

TEST(SemiGlobalMatcher, FindsBothDepthsAndFillsTheRest)
{
  const Pair pair = makePair(320, 96, 1);
  SemiGlobalMatcher::Parameters parameters;
  parameters.disparities = 64;
  const DisparityImage image =
      SemiGlobalMatcher(parameters).estimate(pair.left, pair.right);
  ASSERT_EQ(image.disparity.type(), CV_32FC1);
  ASSERT_EQ(image.disparity.size(), pair.left.size());
  ASSERT_EQ(image.deviation.size(), pair.left.size());
  int near = 0, far = 0, none = 0;
  for (int v = 0; v < image.disparity.rows; ++v)
    for (int u = 0; u < image.disparity.cols; ++u) {
      const float d = image.disparity.at<float>(v, u);
      near += std::abs(d - 23.0f) < 0.5f;
      far += std::abs(d - 7.0f) < 0.5f;
      none += d == 0.0f;
      EXPECT_EQ(d > 0.0f, image.deviation.at<float>(v, u) > 0.0f);
    }
  const int pixels = 320 * 96;
  EXPECT_GT(near, 53 * 71 * 3 / 4); // blocks and smoothing take from its border
  EXPECT_GT(far, pixels * 7 / 10);
  EXPECT_EQ(none, 0);
  parameters.gap_width = 0;
  EXPECT_GT(
      cv::countNonZero(
          SemiGlobalMatcher(parameters).estimate(pair.left, pair.right).disparity == 0),
      100)
      << "what is hidden has no match";
}

TEST(SemiGlobalMatcher, SameForAnyNumberOfThreadsAndForColour)
{
  const Pair pair = makePair(150, 150, 2);
  cv::Mat colours[2];
  cv::cvtColor(pair.left, colours[0], cv::COLOR_GRAY2BGR);
  cv::cvtColor(pair.right, colours[1], cv::COLOR_GRAY2BGR);
  SemiGlobalMatcher matcher;
  setNumberOfThreads(1);
  const cv::Mat expected = matcher.estimate(pair.left, pair.right).disparity;
  for (const int threads : {2, 5}) {
    setNumberOfThreads(threads);
    const cv::Mat found = matcher.estimate(pair.left, pair.right).disparity;
    EXPECT_EQ(cv::norm(found, expected, cv::NORM_INF), 0.0) << threads;
  }
  setNumberOfThreads(0);
  const cv::Mat found = matcher.estimate(colours[0], colours[1]).disparity;
  EXPECT_EQ(cv::norm(found, expected, cv::NORM_INF), 0.0);
}

TEST(SemiGlobalMatcher, TinyAndBlankImages)
{
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(5, 3), cv::Size(70, 2)}) {
    const cv::Mat image(size, CV_8UC1, cv::Scalar(90));
    const cv::Mat disparity = SemiGlobalMatcher().estimate(image, image).disparity;
    EXPECT_EQ(disparity.size(), size);
    EXPECT_EQ(cv::countNonZero(disparity), 0) << "all disparities fit alike";
  }
}

TEST(SemiGlobalMatcher, RefusesWhatDoesNotFit)
{
  const cv::Mat grey(20, 30, CV_8UC1, cv::Scalar(0));
  SemiGlobalMatcher matcher;
  EXPECT_THROW(matcher.estimate(grey, cv::Mat()), BadInputException);
  EXPECT_THROW(matcher.estimate(grey, cv::Mat(20, 31, CV_8UC1)), BadInputException);
  const auto refused = [](auto&& change) {
    SemiGlobalMatcher::Parameters parameters;
    change(parameters);
    EXPECT_THROW(SemiGlobalMatcher{parameters}, InvalidParameterException);
  };
  using Parameters = SemiGlobalMatcher::Parameters;
  refused([](Parameters& p) { p.disparities = 100; });
  refused([](Parameters& p) { p.disparities = 320; });
  refused([](Parameters& p) { p.small_step = 0; });
  refused([](Parameters& p) { p.large_step = p.small_step; });
  refused([](Parameters& p) { p.large_step = 141; });
  refused([](Parameters& p) { p.edge = 0; });
  refused([](Parameters& p) { p.uniqueness = 51; });
  refused([](Parameters& p) { p.smoothing_range = std::nan(""); });
}

} // namespace
} // namespace pcl_semantic
