// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <opencv2/core/mat.hpp>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Writes depths in the format of KITTI's benchmarks: 16-bit PNG, 256 times the
 * depth.
 * \param[in] depth CV_32FC1 or CV_64FC1 [m]; 0 or NaN = none; clamped to 255.99 m, the
 * second-largest number
 * \throws InvalidParameterException for another type (for example integer millimetres),
 * or if a depth is negative
 * \throws OutputException if the file cannot be written */
void writeDepthImage(const std::string& path, const cv::Mat& depth);

/** \brief Reads depths of an image (`.png`), or of the points of a scan (`.bin`: one
 * little-endian float32 per point [m]).
 * \return CV_32FC1 [m], one row for a scan; 0 = none, see isMeasuredDepth()
 * \throws BadInputException if it is damaged or a depth is negative */
cv::Mat readDepths(const std::string& path);

} // namespace pcl_semantic
