// SPDX-License-Identifier: BSD-3-Clause
#include "corners.h"

#include <opencv2/features2d.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace pcl_semantic::odometry {

namespace {

constexpr int kCornerBorder = 12; // comparison windows must be inside the image [px]
constexpr int kThreshold = 10;    // of FAST [grey levels]
constexpr int kCornerHalf = 3;    // half width of the eigenvalue window
constexpr double kMinEigenvalue = 100.0;

// Smaller eigenvalue of the gradients' second moments around a pixel.
double
smallerEigenvalue(const cv::Mat& image, int x, int y)
{
  int xx = 0, xy = 0, yy = 0;
  for (int row = y - kCornerHalf; row <= y + kCornerHalf; ++row) {
    const std::uint8_t* const above = image.ptr(row - 1);
    const std::uint8_t* const here = image.ptr(row);
    const std::uint8_t* const below = image.ptr(row + 1);
    for (int column = x - kCornerHalf; column <= x + kCornerHalf; ++column) {
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
  constexpr double taken = std::numeric_limits<double>::infinity();
  std::vector<double> best(std::size_t(columns * rows), kMinEigenvalue);
  std::vector<cv::Point2f> corners(best.size(), {-1.0f, -1.0f});
  for (const cv::Point2f& point : old)
    best[cellOf(point)] = taken;
  std::vector<cv::KeyPoint> candidates;
  cv::FAST(image, candidates, kThreshold, true);
  const cv::Rect inside(kCornerBorder, kCornerBorder, image.cols - 2 * kCornerBorder,
                        image.rows - 2 * kCornerBorder);
  for (const cv::KeyPoint& candidate : candidates) {
    const cv::Point pixel(int(candidate.pt.x), int(candidate.pt.y));
    const std::size_t i = cellOf(candidate.pt);
    if (!inside.contains(pixel) || std::isinf(best[i]))
      continue;
    const double value = smallerEigenvalue(image, pixel.x, pixel.y);
    if (value > best[i]) {
      best[i] = value;
      corners[i] = candidate.pt;
    }
  }
  const auto is_none = [](const cv::Point2f& corner) { return corner.x < 0.0f; };
  corners.erase(std::remove_if(corners.begin(), corners.end(), is_none), corners.end());
  return corners;
}

} // namespace pcl_semantic::odometry
