/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <opencv2/core/mat.hpp>

namespace pcl_semantic {

/** \brief Gives the disparity of every pixel of the left image of a rectified pair. */
class DisparityEstimator {
public:
  virtual ~DisparityEstimator() = default;

  /** \param[in] left CV_8UC3 (BGR) or CV_8UC1
   * \param[in] right as left
   * \return CV_32FC1 of the same size: disparity [px], 0 = none
   * \throws BadInputException if the images do not fit each other */
  virtual cv::Mat estimate(const cv::Mat& left, const cv::Mat& right) = 0;
};

} // namespace pcl_semantic
