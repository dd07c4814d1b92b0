// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/stereo/row_check.h>

#include "image_pair.h"
#include "images/grey_image.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

constexpr int half = 7;   // of a patch [px]
constexpr int search = 8; // rows above and below [px]
constexpr int border = half + search + 1;
constexpr int corners = 300;
constexpr double alike = 0.9;  // correlation of a match
constexpr double clear = 0.05; // between it and the best of other places

// Row of the best match relative to its own; false if there is no clear one.
bool
findRow(const cv::Mat& left, const cv::Mat& right, const cv::Point& corner,
        double& offset)
{
  const int reach = left.cols / 4;
  const int first = std::max(half, corner.x - reach);
  const int last = std::min(left.cols - half - 1, corner.x + search);
  const cv::Rect patch(corner.x - half, corner.y - half, 2 * half + 1, 2 * half + 1);
  const cv::Rect strip(first - half, corner.y - half - search,
                       last - first + 2 * half + 1, 2 * (half + search) + 1);
  cv::Mat1f scores;
  cv::matchTemplate(right(strip), left(patch), scores, cv::TM_CCOEFF_NORMED);
  double best = 0.0;
  cv::Point at;
  cv::minMaxLoc(scores, nullptr, &best, nullptr, &at);
  if (!(best > alike) || at.y == 0 || at.y == scores.rows - 1)
    return false;
  const double above = scores(at.y - 1, at.x), below = scores(at.y + 1, at.x);
  const cv::Rect peak(at.x - half, at.y - half, 2 * half + 1, 2 * half + 1);
  scores(peak & cv::Rect({}, scores.size())) = -1.0f;
  double second = 0.0;
  cv::minMaxLoc(scores, nullptr, &second);
  const double bend = above - 2.0 * best + below; // of a parabola through three rows
  if (second > best - clear || !(bend < 0.0))
    return false;
  offset = at.y - search + 0.5 * (above - below) / bend;
  return true;
}

} // namespace

RowCheck
checkRows(const cv::Mat& left, const cv::Mat& right)
{
  requireImagePair(left, right);
  const cv::Mat a = greyImage(left), b = greyImage(right);
  if (a.cols <= 2 * border || a.rows <= 2 * border)
    return {};
  std::vector<cv::Point2f> found;
  const cv::Rect inside(border, border, a.cols - 2 * border, a.rows - 2 * border);
  cv::goodFeaturesToTrack(a(inside), found, corners, 0.01, half);
  std::vector<double> offsets;
  for (const cv::Point2f& corner : found) {
    double offset = 0.0;
    if (findRow(a, b, cv::Point(corner) + inside.tl(), offset))
      offsets.push_back(std::abs(offset));
  }
  RowCheck check;
  check.matches = int(offsets.size());
  if (!offsets.empty()) {
    std::sort(offsets.begin(), offsets.end());
    check.median = offsets[offsets.size() / 2];
    check.most = offsets[offsets.size() * 9 / 10];
  }
  return check;
}

} // namespace pcl_semantic
