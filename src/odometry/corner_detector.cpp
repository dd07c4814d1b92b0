// SPDX-License-Identifier: BSD-3-Clause
#include "corner_detector.h"

#include <opencv2/features2d.hpp>

#include <cmath>
#include <cstdint>

namespace pcl_semantic::odometry {

namespace {

constexpr int kBorder = 12;    // windows are compared whole [px]
constexpr int kThreshold = 10; // of FAST, grey levels
constexpr int kHalf = 3;       // window of the eigenvalue

// Smaller eigenvalue of the gradients' second moments around a pixel.
double
smallerEigenvalue(const cv::Mat& image, int x, int y)
{
  int xx = 0, xy = 0, yy = 0;
  for (int row = y - kHalf; row <= y + kHalf; ++row) {
    const std::uint8_t* const above = image.ptr(row - 1);
    const std::uint8_t* const here = image.ptr(row);
    const std::uint8_t* const below = image.ptr(row + 1);
    for (int column = x - kHalf; column <= x + kHalf; ++column) {
      const int dx = here[column + 1] - here[column - 1];
      const int dy = below[column] - above[column];
      xx += dx * dx;
      xy += dx * dy;
      yy += dy * dy;
    }
  }
  const double half = 0.5 * (xx + yy), difference = 0.5 * (xx - yy);
  return half - std::sqrt(difference * difference + double(xy) * xy);
}

} // namespace

std::vector<cv::Point2f>
detectCorners(const cv::Mat& image, const std::vector<cv::Point2f>& old, int wanted)
{
  const double cell =
      std::max(4.0, std::sqrt(double(image.cols) * image.rows / std::max(wanted, 1)));
  const int columns = int(image.cols / cell) + 1, rows = int(image.rows / cell) + 1;
  const auto cellOf = [&](const cv::Point2f& point) {
    return std::size_t(int(point.y / cell) * columns + int(point.x / cell));
  };
  std::vector<char> taken(std::size_t(columns * rows), 0);
  for (const cv::Point2f& point : old)
    taken[cellOf(point)] = 1;
  std::vector<cv::KeyPoint> candidates;
  cv::FAST(image, candidates, kThreshold, true);
  std::vector<double> best(taken.size(), 100.0);
  std::vector<cv::Point2f> corners(taken.size(), {-1.0f, -1.0f});
  for (const cv::KeyPoint& candidate : candidates) {
    const int x = int(candidate.pt.x), y = int(candidate.pt.y);
    if (x < kBorder || y < kBorder || x >= image.cols - kBorder ||
        y >= image.rows - kBorder || taken[cellOf(candidate.pt)])
      continue;
    const double value = smallerEigenvalue(image, x, y);
    if (value > best[cellOf(candidate.pt)]) {
      best[cellOf(candidate.pt)] = value;
      corners[cellOf(candidate.pt)] = candidate.pt;
    }
  }
  std::vector<cv::Point2f> found;
  for (const cv::Point2f& corner : corners)
    if (corner.x >= 0.0f)
      found.push_back(corner);
  return found;
}

} // namespace pcl_semantic::odometry
