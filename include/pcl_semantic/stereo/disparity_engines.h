// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <opencv2/core/mat.hpp>

#include <memory>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Disparities of the left image and their standard deviations. */
struct DisparityImage {
  cv::Mat disparity; ///< CV_32FC1 [px], 0 = none
  cv::Mat deviation; ///< CV_32FC1, standard deviation of the disparity [px]
};

/** \brief Removes disparities with a larger standard deviation [px]; 0 = none. */
inline void
eraseUnsure(DisparityImage& image, double max_deviation)
{
  if (max_deviation > 0.0)
    image.disparity.setTo(0.0, image.deviation > max_deviation);
}

/** \brief Renders disparities as colours: far is blue, near is red, none is black.
 * \param[in] disparity CV_32FC1 [px], 0 = none
 * \param[in] nearest disparity from which the colour is red [px]; positive
 * \return CV_8UC3 (BGR)
 * \throws InvalidParameterException for another type, or unless \a nearest is positive
 */
cv::Mat drawDisparity(const cv::Mat& disparity, double nearest = 128.0);

/** \brief Estimates the disparity of every pixel of the left image of a rectified pair.
 * Not thread-safe. */
class DisparityEstimator {
public:
  virtual ~DisparityEstimator() = default;

  /** \param[in] left CV_8UC3 (BGR) or CV_8UC1; colours are matched as grey levels
   * \param[in] right as left
   * \return images of the same size; they do not depend on the number of threads
   * \throws BadInputException if the images do not match in size or type, or for `elas`
   * if they are larger than 16384 pixels across */
  virtual DisparityImage estimate(const cv::Mat& left, const cv::Mat& right) = 0;
};

/** \brief Names of the engines, the best first: `sgm` (SemiGlobalMatcher), `elas`
 * (Elas) and `sgbm` (OpenCV's semi-global matching). */
const std::vector<std::string>& disparityEngines();

/** \brief Makes an engine with its defaults.
 * \param[in] name one of disparityEngines()
 * \param[in] disparities largest disparity + 1 [px]; a multiple of 16 up to 1024, for
 * `sgm` of 64 up to 256
 * \throws InvalidParameterException for another name or number of disparities */
std::unique_ptr<DisparityEstimator> makeDisparityEstimator(const std::string& name,
                                                           int disparities);

} // namespace pcl_semantic
