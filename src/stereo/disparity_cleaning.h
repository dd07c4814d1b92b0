// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/stereo/disparity_engines.h>

#include <opencv2/core/mat.hpp>

namespace pcl_semantic {

// Disparities here are CV_16SC1, integers in units of 1 / kernels::disparity_steps px;
// below 0 = none.

/** \brief Removes segments of fewer than \a size pixels; neighbours whose disparities
 * differ by at most \a range belong to one segment. */
void removeSmallSegments(int size, int range, cv::Mat& disparity);

/** \brief Replaces every disparity by the mean of those within 5 pixels along the
 * column, then along the row, that differ by at most 4 px. This preserves planes. */
void smoothDisparity(cv::Mat& disparity);

/** \brief Fills gaps in rows: linearly if the disparities at both ends differ by at
 * most \a step; otherwise with the smaller one, because occluded pixels are behind; at
 * the border with the only one.
 * \return disparities in pixels and their standard deviation, one of three values:
 * matched, filled between similar ends, filled otherwise */
DisparityImage fillGaps(int step, const cv::Mat& disparity);

/** \brief Cleans the disparities of an engine: removes small segments, smooths the rest
 * and fills the gaps.
 * \param[in] gap_step see fillGaps() [px] */
DisparityImage cleanDisparity(int smoothing_rounds, int gap_step, cv::Mat disparity);

} // namespace pcl_semantic
