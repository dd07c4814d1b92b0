// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <opencv2/core/mat.hpp>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief What is known of the disparity of every pixel of the left image. */
struct DisparityImage {
  cv::Mat disparity; ///< CV_32FC1 [px], 0 = none
  cv::Mat deviation; ///< CV_32FC1, standard deviation of the disparity [px]
};

/** \brief Takes out the disparities of a larger standard deviation [px]; 0 = none. */
inline void
eraseUnsure(DisparityImage& image, double max_deviation)
{
  if (max_deviation > 0.0)
    image.disparity.setTo(0.0, image.deviation > max_deviation);
}

/** \brief Gives the disparity of every pixel of the left image of a rectified pair. */
class DisparityEstimator {
public:
  virtual ~DisparityEstimator() = default;

  /** \param[in] left CV_8UC3 (BGR) or CV_8UC1
   * \param[in] right as left
   * \return images of the same size
   * \throws BadInputException if the images do not fit each other */
  virtual DisparityImage estimate(const cv::Mat& left, const cv::Mat& right) = 0;
};

} // namespace pcl_semantic
