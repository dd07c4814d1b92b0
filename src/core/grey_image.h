// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

namespace pcl_semantic {

/** \brief A grey image as it is, a colour one (BGR) as grey.
 * \param[in] image CV_8UC1 or CV_8UC3
 * \return CV_8UC1; the same memory if it was grey */
cv::Mat greyImage(const cv::Mat& image);

} // namespace pcl_semantic
