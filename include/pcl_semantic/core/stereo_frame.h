// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <opencv2/core/mat.hpp>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Which frame of a sequence, and when it was taken. */
struct FrameTime {
  int number = 0;         ///< may have gaps
  double timestamp = 0.0; ///< [s]
};

/** \brief One rectified stereo pair. */
struct StereoFrame : FrameTime {
  cv::Mat left;  ///< CV_8UC3 (BGR) or CV_8UC1
  cv::Mat right; ///< as left
};

} // namespace pcl_semantic
