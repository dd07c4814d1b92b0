// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/trajectory_picture.h>

#include <opencv2/imgproc.hpp>

#include <cmath>
#include <sstream>

namespace pcl_semantic {

namespace {

constexpr int kMargin = 40; // [px]

// Positions from above: x to the right, z up, in the axes of the first pose.
std::vector<cv::Point2d>
seenFromAbove(const Trajectory& trajectory)
{
  const Eigen::Isometry3d T_first = trajectory.front().inverse();
  std::vector<cv::Point2d> path;
  for (const Eigen::Isometry3d& pose : trajectory) {
    const Eigen::Vector3d position = T_first * pose.translation();
    path.emplace_back(position.x(), -position.z());
  }
  return path;
}

void
drawPath(cv::Mat& picture, const std::vector<cv::Point2d>& path, double scale,
         const cv::Point2d& origin, const cv::Scalar& colour, int width)
{
  std::vector<cv::Point> line;
  for (const cv::Point2d& point : path)
    line.emplace_back(cvRound(origin.x + scale * point.x),
                      cvRound(origin.y + scale * point.y));
  cv::polylines(picture, line, false, colour, width, cv::LINE_AA);
  cv::circle(picture, line.front(), 5, colour, 1, cv::LINE_AA);
}

// A bar of 1, 2 or 5 times a power of ten metres.
void
drawScale(cv::Mat& picture, double scale)
{
  const double wanted = 0.25 * picture.cols / scale;
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  const double length = power * (wanted / power >= 5.0   ? 5.0
                                 : wanted / power >= 2.0 ? 2.0
                                                         : 1.0);
  const cv::Point begin(kMargin / 2, picture.rows - kMargin / 3);
  const cv::Point end(begin.x + cvRound(length * scale), begin.y);
  cv::line(picture, begin, end, cv::Scalar::all(0), 2);
  std::ostringstream text;
  text << length << " m";
  cv::putText(picture, text.str(), end + cv::Point(8, 4), cv::FONT_HERSHEY_SIMPLEX, 0.5,
              cv::Scalar::all(0), 1, cv::LINE_AA);
}

} // namespace

cv::Mat
drawTrajectories(const Trajectory& first, const Trajectory& second, int size)
{
  if (first.empty() || second.empty())
    PCL_THROW_EXCEPTION(InvalidParameterException, "a path without poses to draw");
  if (size < 3 * kMargin || size > 16384)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "a picture of " << size << " pixels");
  const std::vector<cv::Point2d> one = seenFromAbove(first),
                                 two = seenFromAbove(second);
  cv::Point2d low = one[0], high = one[0];
  for (const std::vector<cv::Point2d>* const path : {&one, &two})
    for (const cv::Point2d& point : *path) {
      low = {std::min(low.x, point.x), std::min(low.y, point.y)};
      high = {std::max(high.x, point.x), std::max(high.y, point.y)};
    }
  const double extent = std::max({high.x - low.x, high.y - low.y, 1.0});
  const double scale = (size - 2 * kMargin) / extent;
  const cv::Point2d middle = 0.5 * (low + high);
  const cv::Point2d origin(0.5 * size - scale * middle.x,
                           0.5 * size - scale * middle.y);
  cv::Mat picture(size, size, CV_8UC3, cv::Scalar::all(255));
  drawPath(picture, one, scale, origin, cv::Scalar(150, 150, 150), 3);
  drawPath(picture, two, scale, origin, cv::Scalar(40, 40, 220), 1);
  drawScale(picture, scale);
  return picture;
}

} // namespace pcl_semantic
