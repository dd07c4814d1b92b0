// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <opencv2/core/mat.hpp>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Writes depths as KITTI's benchmarks do: 16-bit PNG, 256 times the depth.
 * \param[in] depth CV_32FC1 or CV_64FC1 [m]; 0 or NaN = none; more than 255.99 m is
 * written as that, the largest number but one \throws InvalidParameterException for
 * another type (of whole millimetres, say), or if a depth is negative \throws
 * OutputException */
void writeDepthImage(const std::string& path, const cv::Mat& depth);

/** \brief Reads depths of an image (`.png`), or of the points of a scan (`.bin`:
 * float32 a point, little-endian [m]).
 * \return CV_32FC1 [m], that of a scan has one row; 0 = none, see isMeasuredDepth()
 * \throws BadInputException if it is damaged or a depth is negative */
cv::Mat readDepths(const std::string& path);

} // namespace pcl_semantic
