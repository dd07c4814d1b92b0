// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/imgproc.hpp>

namespace pcl_semantic {

/** \brief Converts an image to a number of channels; an image that has them is returned
 * unchanged and shares its memory.
 * \param[in] code of cv::cvtColor() */
inline cv::Mat
withChannels(const cv::Mat& image, int channels, int code)
{
  if (image.channels() == channels)
    return image;
  cv::Mat converted;
  cv::cvtColor(image, converted, code);
  return converted;
}

/** \brief CV_8UC1 from CV_8UC1 or CV_8UC3 (BGR). */
inline cv::Mat
greyImage(const cv::Mat& image)
{
  return withChannels(image, 1, cv::COLOR_BGR2GRAY);
}

/** \brief CV_8UC3 (BGR) from CV_8UC1 or CV_8UC3. */
inline cv::Mat
colourImage(const cv::Mat& image)
{
  return withChannels(image, 3, cv::COLOR_GRAY2BGR);
}

} // namespace pcl_semantic
