// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include <vector>

namespace pcl_semantic::odometry {

/** \brief Detects new corners, at most one in each grid cell without an old one.
 *
 * Candidates come from FAST. In each cell, the candidate that localises best wins
 * (largest smaller eigenvalue of the gradients, Shi and Tomasi 1994).
 * \param[in] image CV_8UC1
 * \param[in] old points that are already tracked
 * \param[in] wanted approximate number of grid cells */
std::vector<cv::Point2f> detectCorners(const cv::Mat& image,
                                       const std::vector<cv::Point2f>& old, int wanted);

} // namespace pcl_semantic::odometry
