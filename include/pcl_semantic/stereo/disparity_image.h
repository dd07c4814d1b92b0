// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <opencv2/core/mat.hpp>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Disparities as colours: far is blue, near is red, none is black.
 * \param[in] disparity CV_32FC1 [px], 0 = none
 * \param[in] nearest disparity that is red, and what is larger [px]; more than 0
 * \return CV_8UC3 (BGR)
 * \throws InvalidParameterException if type or \a nearest do not fit */
cv::Mat drawDisparity(const cv::Mat& disparity, double nearest = 128.0);

} // namespace pcl_semantic
