// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/stereo/disparity_estimator.h>

#include <opencv2/core/mat.hpp>

namespace pcl_semantic {

// Disparities here are whole numbers of 1 / kernels::disparity_steps px.

/** \brief Drops segments of fewer than \a size pixels: neighbours whose disparities
 * differ by no more than \a range belong together.
 * \param[in,out] disparity CV_16SC1; below 0 = none */
void removeSmallSegments(int size, int range, cv::Mat& disparity);

/** \brief Replaces every disparity by the mean of those along the column, then along
 * the row, that differ from it by no more than \a range: planes stay as they are.
 * \param[in,out] disparity CV_16SC1; below 0 = none, stays
 * \param[in] radius of the line [px], up to kernels::max_smoothing */
void smoothDisparity(int radius, int range, cv::Mat& disparity);

/** \brief Fills what lies between two pixels of a row: on a line from one to the other
 * if their disparities differ by no more than \a step, else with the smaller one, for
 * what is hidden lies behind; at the border with the only one.
 * \param[in] longest gaps of more pixels stay [px]
 * \param[in] disparity CV_16SC1; below 0 = none
 * \return disparities in pixels, and how sure they are */
DisparityImage fillGaps(int longest, int step, const cv::Mat& disparity);

} // namespace pcl_semantic
