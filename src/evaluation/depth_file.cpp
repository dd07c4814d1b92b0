// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/evaluation/depth_file.h>

#include "core/fail.h"

#include <pcl_semantic/core/measured_depth.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/images/image_file.h>

#include <opencv2/core.hpp>

#include <cmath>
#include <cstring>
#include <filesystem>

namespace pcl_semantic {

namespace {

constexpr double steps_per_metre = 256.0;

cv::Mat
readPointDepths(const std::string& path)
{
  const std::vector<std::uint8_t> bytes = readBytes(path);
  if (bytes.empty() || bytes.size() % sizeof(float) != 0)
    badInput(path, ": has ", bytes.size(), " bytes, expected float32 a point");
  cv::Mat1f depths(1, static_cast<int>(bytes.size() / sizeof(float)));
  std::memcpy(depths.data, bytes.data(), bytes.size());
  for (int i = 0; i < depths.cols; ++i)
    if (depths(0, i) < 0.0f)
      badInput(path, ": point ", i, " has depth ", depths(0, i),
               ", expected 0 or more");
    else if (!isMeasuredDepth(depths(0, i)))
      depths(0, i) = 0.0f;
  return depths;
}

} // namespace

void
writeDepthImage(const std::string& path, const cv::Mat& depth)
{
  if (depth.type() != CV_32FC1 && depth.type() != CV_64FC1)
    badParameter(path, ": depths are floats of one channel [m], not an image of type ",
                 cv::typeToString(depth.type()));
  double nearest = 0.0;
  cv::minMaxIdx(cv::max(-depth, 0.0), nullptr, &nearest); // NaN counts as none
  if (nearest > 0.0)
    badParameter(path, ": a depth is ", -nearest, " m, expected 0 or more");
  cv::Mat image;
  depth.convertTo(image, CV_16U, steps_per_metre); // rounds and saturates
  for (std::uint16_t& value : cv::Mat1w(image))
    if (value != 0 && !isMeasuredDepth(value))
      --value; // largest depth of the format
  writePng(path, image);
}

cv::Mat
readDepths(const std::string& path)
{
  if (std::filesystem::path(path).extension() == ".bin")
    return readPointDepths(path);
  cv::Mat1w image = readPng(path, ImageKind::disparity);
  for (std::uint16_t& value : image)
    if (!isMeasuredDepth(value))
      value = 0;
  cv::Mat depth;
  image.convertTo(depth, CV_32F, 1.0 / steps_per_metre);
  return depth;
}

} // namespace pcl_semantic
