// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <opencv2/core/mat.hpp>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Median grey level of an image, 0 to 255.
 * \param[in] image CV_8UC3 (BGR) or CV_8UC1, not empty */
int medianGrey(const cv::Mat& image);

} // namespace pcl_semantic
