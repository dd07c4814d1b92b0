// SPDX-License-Identifier: BSD-3-Clause

#include "grey_image.h"

#include <opencv2/imgproc.hpp>

namespace pcl_semantic {

cv::Mat
greyImage(const cv::Mat& image)
{
  if (image.channels() == 1)
    return image;
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

} // namespace pcl_semantic
