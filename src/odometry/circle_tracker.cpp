// SPDX-License-Identifier: BSD-3-Clause
#include "circle_tracker.h"

#include <opencv2/video/tracking.hpp>

#include <cmath>
#include <cstdint>

namespace pcl_semantic::odometry {

namespace {

constexpr int kLevels = 3;        // above the images themselves
const cv::Size kWindow(11, 11);   // [px]
constexpr float kCircle = 1.0f;   // how far from the start a circle may end [px]
constexpr float kRowError = 1.5f; // between left and right [px]
constexpr float kBorder = 8.0f;   // [px]

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

void
CircleTracker::push(const cv::Mat& left, const cv::Mat& right)
{
  std::swap(left_before_, left_now_);
  std::swap(right_before_, right_now_);
  cv::parallel_for_({0, 2}, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      // A copy: the caller may use the image's memory for the next one. Every second
      // matrix holds the derivatives of the one before it.
      std::vector<cv::Mat> pyramid;
      cv::buildOpticalFlowPyramid(i ? right : left, pyramid, kWindow, kLevels, true,
                                  cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT, false);
      (i ? right_now_ : left_now_) = pyramid;
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
  follow(left_before_, left_now_, kLevels, left_before, left_now, in_left);
  for (std::size_t i = 0; i < before.size(); ++i)
    right_now.push_back(left_now[i] + now[i].right - now[i].left);
  follow(left_now_, right_now_, 1, left_now, right_now, in_right);
  std::vector<cv::Point2f> end = right_before;
  follow(right_now_, right_before_, 1, right_now, end, in_circle);
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
  follow(left_now_, right_now_, 0, left, right, there);
  std::vector<cv::Point2f> end = left;
  follow(right_now_, left_now_, 0, right, end, back);
  for (std::size_t i = 0; i < features.size(); ++i) {
    features[i].right = right[i];
    features[i].is_found = there[i] && back[i] && isInside(right[i], this->right()) &&
                           cv::norm(end[i] - left[i]) < 0.5 * kCircle &&
                           std::abs(left[i].y - right[i].y) < kRowError;
  }
}

} // namespace pcl_semantic::odometry
