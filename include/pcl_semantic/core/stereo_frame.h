// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <opencv2/core/mat.hpp>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief One rectified stereo pair. */
struct StereoFrame {
  int number = 0;         ///< frame number of the sequence; may have gaps
  double timestamp = 0.0; ///< [s]
  cv::Mat left;           ///< CV_8UC3 (BGR) or CV_8UC1
  cv::Mat right;          ///< as left
};

/** \brief A frame that nobody has to read yet. */
struct FrameTime {
  int number = 0;         ///< as in StereoFrame
  double timestamp = 0.0; ///< [s]
};

} // namespace pcl_semantic
