// SPDX-License-Identifier: BSD-3-Clause
#include "image_pair.h"
#include "core/fail.h"

namespace pcl_semantic {

void
requireImagePair(const cv::Mat& left, const cv::Mat& right)
{
  if (left.empty() || (left.type() != CV_8UC1 && left.type() != CV_8UC3))
    badInput("left image: expected 8-bit grey or 8-bit colour");
  if (left.size() != right.size())
    badInput("right image is ", right.cols, " x ", right.rows, " pixels, the left one ",
             left.cols, " x ", left.rows);
  if (left.type() != right.type())
    badInput("right image has ", right.channels(), " channel(s), the left one ",
             left.channels());
}

} // namespace pcl_semantic
