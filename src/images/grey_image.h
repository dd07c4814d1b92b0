// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/imgproc.hpp>

namespace pcl_semantic {

/** \brief Converts a colour image (BGR) to grey; a grey image is returned unchanged.
 * \param[in] image CV_8UC1 or CV_8UC3
 * \return CV_8UC1; shares memory with a grey \a image */
inline cv::Mat
greyImage(const cv::Mat& image)
{
  if (image.channels() == 1)
    return image;
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

} // namespace pcl_semantic
