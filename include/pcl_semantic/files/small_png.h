// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <opencv2/core/mat.hpp>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Writes a picture for pages and mails: colours in steps of 8 and packed as
 * hard as PNG goes, about half the bytes of writePng(). Not for labels or measurements.
 * \param[in] picture CV_8UC3
 * \throws InvalidParameterException if it is of another type
 * \throws OutputException; nothing is left behind then */
void writeSmallPng(const std::string& path, const cv::Mat& picture);

} // namespace pcl_semantic
