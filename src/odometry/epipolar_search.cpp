// SPDX-License-Identifier: BSD-3-Clause
#include "epipolar_search.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace pcl_semantic::odometry {

namespace {

constexpr int kHalf = 5;
constexpr int kPixels = (2 * kHalf + 1) * (2 * kHalf + 1);
constexpr double kClear = 0.8; // of the second best, elsewhere on the row

} // namespace

int
searchDisparity(const cv::Mat& left, const cv::Mat& right, const cv::Point2f& corner,
                int max_disparity)
{
  const int x = cvRound(corner.x), y = cvRound(corner.y);
  if (x < kHalf || y < kHalf || x >= left.cols - kHalf || y >= left.rows - kHalf)
    return -1;
  const int count = std::min(max_disparity, x - kHalf) + 1;
  // costs[k] belongs to disparity count - 1 - k, so that both are read forwards.
  std::vector<std::uint16_t> costs(std::size_t(count), 0);
  for (int dy = -kHalf; dy <= kHalf; ++dy)
    for (int dx = -kHalf; dx <= kHalf; ++dx) {
      const int value = left.ptr(y + dy)[x + dx];
      const std::uint8_t* const row = right.ptr(y + dy) + x + dx - (count - 1);
      for (int k = 0; k < count; ++k)
        costs[std::size_t(k)] =
            std::uint16_t(costs[std::size_t(k)] + std::abs(value - row[k]));
    }
  const auto best = std::min_element(costs.begin(), costs.end());
  const int at = int(best - costs.begin());
  int second = 255 * kPixels;
  for (int k = 0; k < count; ++k)
    if (std::abs(k - at) > 2)
      second = std::min(second, int(costs[std::size_t(k)]));
  if (*best >= kClear * second || *best > 20 * kPixels)
    return -1;
  return count - 1 - at;
}

} // namespace pcl_semantic::odometry
