// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <opencv2/core/mat.hpp>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Differences between the rows of a pair. */
struct RowCheck {
  int matches = 0;     ///< corners that were found in both images
  double median = 0.0; ///< of the absolute differences of their rows [px]
  double most = 0.0;   ///< 90 % quantile of them [px]

  /** \brief Whether the pair is probably not rectified, see doc/stereo.md. */
  bool
  isDoubtful() const
  {
    return isSure() && most > 1.6;
  }

  /** \brief Whether there are enough matches to judge the pair. */
  bool
  isSure() const
  {
    return matches >= 30;
  }
};

/** \brief Compares the rows of a pair that should be rectified; takes some tens of
 * milliseconds.
 *
 * Up to 300 corners of the left image are searched in the right one by correlation, up
 * to eight rows above and below, and up to a quarter of the width to the left.
 * \param[in] left CV_8UC3 (BGR) or CV_8UC1, of any size
 * \param[in] right as left
 * \throws BadInputException if the images do not match in size or type */
RowCheck checkRows(const cv::Mat& left, const cv::Mat& right);

} // namespace pcl_semantic
