// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

namespace pcl_semantic {

/** \brief What every estimator wants of its two images.
 * \throws BadInputException unless both are 8-bit grey or colour, of one size and type
 */
void requireImagePair(const cv::Mat& left, const cv::Mat& right);

} // namespace pcl_semantic
