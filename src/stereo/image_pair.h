// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

namespace pcl_semantic {

/** \brief Checks the two images of an estimator.
 * \throws BadInputException unless both are 8-bit grey or colour, of the same size and
 * type */
void requireImagePair(const cv::Mat& left, const cv::Mat& right);

} // namespace pcl_semantic
