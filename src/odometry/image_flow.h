// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include <cstdint>
#include <vector>

namespace pcl_semantic::odometry {

/** \brief Pyramid of an image for Lucas-Kanade; the image is its first matrix. Every
 * second matrix contains the derivatives of the previous one. */
using ImagePyramid = std::vector<cv::Mat>;

constexpr int kPyramidLevels = 3; ///< above the image

/** \param[in] image CV_8UC1, copied */
ImagePyramid pyramidOf(const cv::Mat& image);

/** \brief Whether a point is so far inside that it can be tracked. */
bool isInside(const cv::Point2f& point, const cv::Mat& image);

/** \brief Follows points from one image to another by pyramidal Lucas-Kanade.
 * \param[in] levels of the pyramids, up to kPyramidLevels
 * \param[in,out] end predicted, then found positions [px]
 * \param[out] found 1 for each point that was found */
void follow(const ImagePyramid& from, const ImagePyramid& to, int levels,
            const std::vector<cv::Point2f>& start, std::vector<cv::Point2f>& end,
            std::vector<std::uint8_t>& found);

} // namespace pcl_semantic::odometry
