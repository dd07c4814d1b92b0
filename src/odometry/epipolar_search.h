// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace pcl_semantic::odometry {

/** \brief Whole-pixel disparity of a corner of the left image: the smallest sum of
 * absolute differences of 11 x 11 pixels along the row of the right image.
 * \return -1 if there is no clear one */
int searchDisparity(const cv::Mat& left, const cv::Mat& right,
                    const cv::Point2f& corner, int max_disparity);

} // namespace pcl_semantic::odometry
