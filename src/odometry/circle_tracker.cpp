// SPDX-License-Identifier: BSD-3-Clause
#include "circle_tracker.h"

#include <opencv2/features2d.hpp>
#include <opencv2/video/tracking.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

namespace pcl_semantic::odometry {

namespace {

constexpr int kCornerBorder = 12; // comparison windows must be inside the image [px]
constexpr int kThreshold = 10;    // of FAST [grey levels]
constexpr int kCornerHalf = 3;    // half width of the eigenvalue window
constexpr double kMinEigenvalue = 100.0;

constexpr int kSearchHalf = 5;
constexpr int kPixels = (2 * kSearchHalf + 1) * (2 * kSearchHalf + 1);
constexpr double kClear = 0.8; // ratio to the second-best cost elsewhere on the row

constexpr int kLevels = 3;        // pyramid levels above the image
const cv::Size kWindow(11, 11);   // [px]
constexpr float kCircle = 1.0f;   // maximum distance of a circle's end from its start
                                  // [px]
constexpr float kRowError = 1.5f; // between left and right [px]
constexpr float kBorder = 8.0f;   // [px]

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

bool
isInside(const cv::Point2f& point, const cv::Mat& image)
{
  return point.x >= kBorder && point.y >= kBorder &&
         point.x < float(image.cols) - kBorder && point.y < float(image.rows) - kBorder;
}

void
follow(const std::vector<cv::Mat>& from, const std::vector<cv::Mat>& to, int levels,
       const std::vector<cv::Point2f>& start, std::vector<cv::Point2f>& end,
       std::vector<std::uint8_t>& found)
{
  found.clear();
  if (start.empty())
    return;
  cv::calcOpticalFlowPyrLK(from, to, start, end, found, cv::noArray(), kWindow, levels,
                           {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 20, 0.01},
                           cv::OPTFLOW_USE_INITIAL_FLOW, 1e-4);
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

int
searchDisparity(const cv::Mat& left, const cv::Mat& right, const cv::Point2f& corner,
                int max_disparity)
{
  const int x = cvRound(corner.x), y = cvRound(corner.y);
  if (x < kSearchHalf || y < kSearchHalf || x >= left.cols - kSearchHalf ||
      y >= left.rows - kSearchHalf)
    return -1;
  const int count = std::min(max_disparity, x - kSearchHalf) + 1;
  // costs[k] belongs to disparity count - 1 - k, so that both arrays are read forwards.
  std::vector<std::uint16_t> costs(std::size_t(count), 0);
  for (int dy = -kSearchHalf; dy <= kSearchHalf; ++dy)
    for (int dx = -kSearchHalf; dx <= kSearchHalf; ++dx) {
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

void
CircleTracker::push(const cv::Mat& left, const cv::Mat& right)
{
  std::swap(before_, now_);
  cv::parallel_for_({0, 2}, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      // Copies, because the caller may reuse the image's memory. Every second matrix
      // contains the derivatives of the previous one.
      Pyramid pyramid;
      cv::buildOpticalFlowPyramid(i ? right : left, pyramid, kWindow, kLevels, true,
                                  cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT, false);
      (i ? now_.right : now_.left) = pyramid;
    }
  });
}

void
CircleTracker::track(const std::vector<StereoFeature>& before,
                     std::vector<StereoFeature>& now) const
{
  std::vector<cv::Point2f> left_before, left_now, right_now, right_before;
  std::vector<std::uint8_t> in_left, in_right, in_circle;
  for (std::size_t i = 0; i < before.size(); ++i) {
    left_before.push_back(before[i].left);
    left_now.push_back(now[i].left);
    right_before.push_back(before[i].right);
  }
  follow(before_.left, now_.left, kLevels, left_before, left_now, in_left);
  for (std::size_t i = 0; i < before.size(); ++i)
    right_now.push_back(left_now[i] + now[i].right - now[i].left);
  follow(now_.left, now_.right, 1, left_now, right_now, in_right);
  std::vector<cv::Point2f> end = right_before;
  follow(now_.right, before_.right, 1, right_now, end, in_circle);
  for (std::size_t i = 0; i < before.size(); ++i) {
    now[i].left = left_now[i];
    now[i].right = right_now[i];
    now[i].is_found = in_left[i] && in_right[i] && in_circle[i] &&
                      isInside(left_now[i], left()) &&
                      isInside(right_now[i], right()) &&
                      cv::norm(end[i] - right_before[i]) < kCircle &&
                      std::abs(left_now[i].y - right_now[i].y) < kRowError;
  }
}

void
CircleTracker::matchStereo(std::vector<StereoFeature>& features) const
{
  std::vector<cv::Point2f> left, right;
  std::vector<std::uint8_t> there, back;
  for (const StereoFeature& feature : features) {
    left.push_back(feature.left);
    right.push_back(feature.right);
  }
  follow(now_.left, now_.right, 0, left, right, there);
  std::vector<cv::Point2f> end = left;
  follow(now_.right, now_.left, 0, right, end, back);
  for (std::size_t i = 0; i < features.size(); ++i) {
    features[i].right = right[i];
    features[i].is_found = there[i] && back[i] && isInside(right[i], this->right()) &&
                           cv::norm(end[i] - left[i]) < 0.5 * kCircle &&
                           std::abs(left[i].y - right[i].y) < kRowError;
  }
}

} // namespace pcl_semantic::odometry
