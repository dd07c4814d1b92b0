// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace pcl_semantic {

/** \brief Splits labels into connected segments (over edges of pixels). One of fewer
 * than \a smallest pixels joins the neighbour whose mean colour is nearest, a large one
 * if it has any.
 * \param[in] labels CV_32SC1
 * \param[in] image CV_8UC3 of the same size
 * \return CV_32SC1: numbers 0, 1, ... in the order of the first pixels */
cv::Mat connectedSegments(const cv::Mat& labels, const cv::Mat& image,
                          std::size_t smallest);

} // namespace pcl_semantic
