// SPDX-License-Identifier: BSD-3-Clause
#include "circle_tracker.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace pcl_semantic::odometry {

namespace {

constexpr int kSearchHalf = 5;
constexpr int kPixels = (2 * kSearchHalf + 1) * (2 * kSearchHalf + 1);
constexpr double kClear = 0.8; // ratio to the second-best cost elsewhere on the row

constexpr float kCircle = 1.0f;   // maximum distance of a circle's end from its start
                                  // [px]
constexpr float kRowError = 1.5f; // between left and right [px]

} // namespace

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
    for (int i = range.start; i < range.end; ++i)
      (i ? now_.right : now_.left) = pyramidOf(i ? right : left);
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
  follow(before_.left, now_.left, kPyramidLevels, left_before, left_now, in_left);
  for (std::size_t i = 0; i < before.size(); ++i)
    right_now.push_back(left_now[i] + now[i].right - now[i].left);
  follow(now_.left, now_.right, 1, left_now, right_now, in_right);
  std::vector<cv::Point2f> end = right_before;
  follow(now_.right, before_.right, 1, right_now, end, in_circle);
  for (std::size_t i = 0; i < before.size(); ++i) {
    now[i].left = left_now[i];
    now[i].right = right_now[i];
    now[i].is_found = in_left[i] && in_right[i] && in_circle[i] &&
                      isInside(left_now[i], image()) &&
                      isInside(right_now[i], right()) &&
                      cv::norm(end[i] - right_before[i]) < kCircle &&
                      std::abs(left_now[i].y - right_now[i].y) < kRowError;
  }
}

std::vector<StereoFeature>
CircleTracker::featuresAt(const std::vector<cv::Point2f>& corners,
                          int max_disparity) const
{
  std::vector<StereoFeature> features;
  for (const cv::Point2f& corner : corners) {
    const int disparity = searchDisparity(image(), right(), corner, max_disparity);
    if (disparity >= 0)
      features.push_back({corner, {corner.x - float(disparity), corner.y}, false});
  }
  matchStereo(features);
  features.erase(
      std::remove_if(features.begin(), features.end(),
                     [](const StereoFeature& feature) { return !feature.is_found; }),
      features.end());
  return features;
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
