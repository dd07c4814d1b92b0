// SPDX-License-Identifier: BSD-3-Clause
#include "stereo/kernels/smoothing.h"
#include "stereo/semi_global_matcher.h"
#include "support/same_image.h"
#include "support/supported_tiers.h"

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
  PlainMatcher(const Pair& pair, int disparities)
      : pair_(pair), width_(pair.left.cols), height_(pair.left.rows), D_(disparities),
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
  static constexpr int small_step = 24, large_step = 120, edge = 6;
  static constexpr int uniqueness = 5; // [%]
  static constexpr int left_right_tolerance = 1;

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
    return std::max(small_step + 1, large_step * edge / std::max(edge, difference));
  }

  Costs
  next(const Costs& before, const Costs& costs, int jump) const
  {
    const int smallest = *std::min_element(before.begin(), before.end());
    Costs path(costs.size());
    for (std::size_t d = 0; d < costs.size(); ++d) {
      int best = std::min(before[d], smallest + jump);
      if (d > 0)
        best = std::min(best, before[d - 1] + small_step);
      if (d + 1 < costs.size())
        best = std::min(best, before[d + 1] + small_step);
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
    const int limit = int(float(smallest) * (100.0f / float(100 - uniqueness)));
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
    if (std::abs(theirs - d) > left_right_tolerance)
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
  int width_, height_, D_;
  std::vector<std::bitset<64>> left_, right_; // censuses
};

TEST(SemiGlobalMatcher, EqualsAPlainOneInEveryTier)
{
  for (const int disparities : {64, 128}) {
    const Pair pair = makePair(101, 40, unsigned(disparities));
    const CensusImage left(pair.left, CensusImage::Order::forwards, 0);
    const CensusImage right(pair.right, CensusImage::Order::backwards,
                            disparities + kernels::disparity_block);
    const PlainMatcher plain(pair, disparities);
    // A band at the top, and one that begins 16 rows above its first row.
    const cv::Mat top = plain.match(0, 0, 12), below = plain.match(8, 24, 40);
    EXPECT_GT(cv::countNonZero(top >= 0), 300);
    EXPECT_GT(cv::countNonZero(below >= 0), 500);
    for (const SimdTier tier : supportedTiers()) {
      SemiGlobalBand band({pair.left, left, right}, disparities, tier);
      cv::Mat disparity(pair.left.size(), CV_16SC1);
      band.match(24, 40, disparity);
      EXPECT_TRUE(isSameImage(disparity.rowRange(24, 40), below.rowRange(24, 40)))
          << nameOf(tier);
      band.match(0, 12, disparity); // nothing is left of the band before
      EXPECT_TRUE(isSameImage(disparity.rowRange(0, 12), top.rowRange(0, 12)))
          << nameOf(tier);
    }
  }
}

} // namespace
} // namespace pcl_semantic
