// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include <vector>

namespace pcl_semantic::odometry {

/** \brief New corners, at most one in each cell of a grid that holds no old one.
 *
 * Candidates come from FAST; of a cell's candidates the one is taken whose window
 * localises best (largest smaller eigenvalue of the gradients, Shi and Tomasi 1994).
 * \param[in] image CV_8UC1 \param[in] old points that are followed already
 * \param[in] wanted about how many cells the grid has */
std::vector<cv::Point2f> detectCorners(const cv::Mat& image,
                                       const std::vector<cv::Point2f>& old, int wanted);

} // namespace pcl_semantic::odometry
