// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/stereo/disparity_engines.h>

#include <opencv2/core/mat.hpp>

namespace pcl_semantic {

// Disparities here are CV_16SC1, whole numbers of 1 / kernels::disparity_steps px;
// below 0 = none.

/** \brief Drops segments of fewer than \a size pixels: neighbours whose disparities
 * differ by no more than \a range belong together. */
void removeSmallSegments(int size, int range, cv::Mat& disparity);

/** \brief Replaces every disparity by the mean of those within 5 pixels along the
 * column, then along the row, that differ from it by no more than 4 px: planes stay as
 * they are. */
void smoothDisparity(cv::Mat& disparity);

/** \brief Fills what lies between two pixels of a row: on a line from one to the other
 * if their disparities differ by no more than \a step, else with the smaller one, for
 * what is hidden lies behind; at the border with the only one.
 * \return disparities in pixels, and their standard deviation, one of three values:
 * matched, filled between like ends, filled otherwise */
DisparityImage fillGaps(int step, const cv::Mat& disparity);

/** \brief Cleans the disparities of an engine: drops small segments,
 * smooths the rest and fills the gaps.
 * \param[in] gap_step see fillGaps() [px] */
DisparityImage cleanDisparity(int smoothing_rounds, int gap_step, cv::Mat disparity);

} // namespace pcl_semantic
