// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/dataset/undistorter.h>
#include <pcl_semantic/images/sensor_frame.h>

#include <opencv2/core/mat.hpp>

#include <string>

namespace pcl_semantic {

/** \brief Numbers per metre in depth images. */
struct DepthScale {
  double stated = 0.0; ///< 0 = the layout's
  bool is_tum = false; ///< layout

  /** \brief Number per metre in an image: 5000 in TUM's layout, 1 for floats, else
   * 1000. */
  double of(const cv::Mat& depths) const;

  /** \throws InvalidParameterException unless 0 or at least 1: a smaller scale makes
   * one number more than a metre, and is probably metres per number */
  void validate() const;
};

/** \brief Depths [m]; NaN = none.
 * \param[in] image CV_16UC1 or CV_32FC1 */
cv::Mat1d depthsInMetres(const cv::Mat& image, double scale);

/** \brief Reads a frame and undistorts it.
 * \param[in] max_depth of the points of its cloud [m]; 0 = unlimited
 * \param[in] first path of an image with the size of the camera, for messages
 * \throws BadInputException if an image cannot be read or has another size */
RgbdFrame readRgbdFrame(const std::string& colour, const std::string& depth,
                        const Undistorter& undistorter, const DepthScale& scale,
                        double max_depth, const std::string& first);

} // namespace pcl_semantic
