// SPDX-License-Identifier: BSD-3-Clause
#include "image_flow.h"

#include <opencv2/video/tracking.hpp>

namespace pcl_semantic::odometry {

namespace {

const cv::Size kWindow(11, 11); // [px]
constexpr float kBorder = 8.0f; // [px]

} // namespace

ImagePyramid
pyramidOf(const cv::Mat& image)
{
  ImagePyramid pyramid; // a copy, because the caller may reuse the image's memory
  cv::buildOpticalFlowPyramid(image, pyramid, kWindow, kPyramidLevels, true,
                              cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT, false);
  return pyramid;
}

bool
isInside(const cv::Point2f& point, const cv::Mat& image)
{
  return point.x >= kBorder && point.y >= kBorder &&
         point.x < float(image.cols) - kBorder && point.y < float(image.rows) - kBorder;
}

void
follow(const ImagePyramid& from, const ImagePyramid& to, int levels,
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

} // namespace pcl_semantic::odometry
