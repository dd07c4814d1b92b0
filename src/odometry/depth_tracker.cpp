// SPDX-License-Identifier: BSD-3-Clause
#include "depth_tracker.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace pcl_semantic::odometry {

namespace {

constexpr float kReturn = 1.0f; // maximum distance of the end from the start [px]
constexpr float kEdge = 0.05f;  // ratio of depths around a point at an edge, minus 1

} // namespace

void
DepthTracker::push(const cv::Mat& image, const cv::Mat1f& disparities)
{
  before_ = std::exchange(now_, pyramidOf(image));
  disparities_ = disparities;
}

void
DepthTracker::track(const std::vector<StereoFeature>& before,
                    std::vector<StereoFeature>& now) const
{
  std::vector<cv::Point2f> start, end;
  for (std::size_t i = 0; i < before.size(); ++i) {
    start.push_back(before[i].left);
    end.push_back(now[i].left);
  }
  std::vector<std::uint8_t> there, back;
  follow(before_, now_, kPyramidLevels, start, end, there);
  std::vector<cv::Point2f> returned = start;
  follow(now_, before_, 1, end, returned, back);
  for (std::size_t i = 0; i < before.size(); ++i) {
    now[i].left = end[i];
    now[i].is_found = there[i] && back[i] && isInside(end[i], image()) &&
                      cv::norm(returned[i] - start[i]) < kReturn;
    const float disparity = now[i].is_found ? disparityAt(end[i]) : 0.0f;
    now[i].is_found = disparity > 0.0f;
    now[i].right = end[i] - cv::Point2f(disparity, 0.0f);
  }
}

std::vector<StereoFeature>
DepthTracker::featuresAt(const std::vector<cv::Point2f>& corners,
                         int /*max_disparity*/) const
{
  std::vector<StereoFeature> features;
  for (const cv::Point2f& corner : corners)
    if (const float disparity = disparityAt(corner); disparity > 0.0f)
      features.push_back({corner, corner - cv::Point2f(disparity, 0.0f), true});
  return features;
}

// Interpolates; 0 at an edge of the depths and where one of four pixels has none.
float
DepthTracker::disparityAt(const cv::Point2f& point) const
{
  const int x = int(std::floor(point.x)), y = int(std::floor(point.y));
  if (x < 0 || y < 0 || x + 1 >= disparities_.cols || y + 1 >= disparities_.rows)
    return 0.0f;
  const float a = disparities_(y, x), b = disparities_(y, x + 1);
  const float c = disparities_(y + 1, x), d = disparities_(y + 1, x + 1);
  const auto [least, most] = std::minmax({a, b, c, d});
  if (!(least > 0.0f) || most > least * (1.0f + kEdge))
    return 0.0f;
  const float u = point.x - float(x), v = point.y - float(y);
  return (1.0f - v) * ((1.0f - u) * a + u * b) + v * ((1.0f - u) * c + u * d);
}

} // namespace pcl_semantic::odometry
