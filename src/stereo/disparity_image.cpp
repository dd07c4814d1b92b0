// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/stereo/disparity_image.h>

#include <opencv2/imgproc.hpp>

namespace pcl_semantic {

cv::Mat
drawDisparity(const cv::Mat& disparity, double nearest)
{
  if (disparity.type() != CV_32FC1 || !(nearest > 0.0))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "drawDisparity: expected an image of floats and a disparity "
                        "of more than 0");
  // The root, so that the far half of a street is not all of one colour.
  cv::Mat fraction, levels, picture;
  cv::sqrt(cv::max(disparity, 0.0) / nearest, fraction);
  fraction.convertTo(levels, CV_8UC1, 255.0);
  cv::applyColorMap(levels, picture, cv::COLORMAP_TURBO);
  picture.setTo(cv::Scalar::all(0), ~(disparity > 0.0));
  return picture;
}

} // namespace pcl_semantic
