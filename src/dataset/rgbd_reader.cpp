// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_reader.h"

#include "core/fail.h"

#include <pcl_semantic/core/measured_depth.h>
#include <pcl_semantic/dataset/rgbd_frame.h>
#include <pcl_semantic/images/image_file.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

template <typename T>
cv::Mat1d
inMetres(const cv::Mat_<T>& numbers, double scale)
{
  cv::Mat1d depths(numbers.size());
  std::transform(numbers.begin(), numbers.end(), depths.begin(), [&](T number) {
    return isMeasuredDepth(number) ? double(number) / scale
                                   : std::numeric_limits<double>::quiet_NaN();
  });
  return depths;
}

} // namespace

double
DepthScale::of(const cv::Mat& depths) const
{
  if (stated != 0.0)
    return stated;
  return depths.depth() == CV_32F ? 1.0 : is_tum ? 5000.0 : 1000.0;
}

void
DepthScale::validate() const
{
  if (!(stated >= 0.0 && std::isfinite(stated)))
    badParameter("depth scale is ", stated, ", expected 0 or more");
  if (stated > 0.0 && stated < 1.0)
    badParameter("depth scale is ", stated,
                 ", expected the value of 1 m in the depth images: ", 1.0 / stated,
                 " if the unit is ", stated, " m");
}

cv::Mat1d
depthsInMetres(const cv::Mat& image, double scale)
{
  return image.depth() == CV_32F ? inMetres(cv::Mat1f(image), scale)
                                 : inMetres(cv::Mat1w(image), scale);
}

RgbdFrame
readRgbdFrame(const std::string& colour, const std::string& depth,
              const Undistorter& undistorter, const DepthScale& scale, double max_depth,
              const std::string& first)
{
  const StereoCamera& camera = undistorter.camera();
  const cv::Mat read = readImage(colour);
  if (read.size() != cv::Size(camera.width, camera.height))
    badInput(colour, ": has ", read.cols, " x ", read.rows,
             " pixels, expected those of ", first, ", ", camera.width, " x ",
             camera.height);
  const cv::Mat numbers =
      undistorter.undistortNearest(readDepthImage(depth, read.size(), " as " + colour));
  return rgbdFrameOf(undistorter.undistort(read),
                     depthsInMetres(numbers, scale.of(numbers)), camera, max_depth);
}

} // namespace pcl_semantic
