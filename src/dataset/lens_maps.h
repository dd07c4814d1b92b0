// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include <string>

namespace pcl_semantic {

/** \brief Sources of the pixels of an undistorted image, for `cv::remap()`. */
struct LensMaps {
  cv::Mat2s whole;           ///< whole pixels (x, y), rounded down
  cv::Mat_<ushort> fraction; ///< 32 * y + x in 1/32 px
};

/** \brief A lens in OpenCV's types. */
struct LensModel {
  cv::Mat K, D;
  bool is_fisheye = false; ///< D is k1 k2 k3 k4 of the equidistant model
};

/** \brief Sources of the pixels of a camera with the rotation R and the projection P.
 * \throws cv::Exception */
LensMaps lensMapsOf(const LensModel& lens, const cv::Mat& R, const cv::Mat& P,
                    const cv::Size& size);

/** \brief Requires that pixels have sources in the image, in an unfolded order:
 * polynomials fold an image where they were not fitted, and OpenCV does not check this.
 * \param[in] says end of the message "only N % of ..."
 * \throws InvalidParameterException */
void requireUsable(const LensMaps& maps, const std::string& says);

/** \brief Requires a plausible focal length of undistorted images; another one means a
 * badly fitted distortion polynomial.
 * \throws InvalidParameterException */
void requireFocalLength(double undistorted, double original, const std::string& advice);

} // namespace pcl_semantic
