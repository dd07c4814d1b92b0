// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/images/sensor_frame.h>

#include <opencv2/core/mat.hpp>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Makes the frame of an RGB-D camera from images in memory; number and time are
 * left to the caller.
 * \param[in] image CV_8UC3 (BGR) or CV_8UC1, undistorted
 * \param[in] depths of its pixels along the optical axis [m]; 0, less and non-finite
 * values are no depths
 * \param[in] camera of the image; its baseline is ignored
 * \param[in] max_depth of the points of the cloud [m]; 0 = unlimited
 * \throws InvalidParameterException unless both images have the camera's size, or for
 * another type of image */
RgbdFrame rgbdFrameOf(const cv::Mat& image, const cv::Mat1d& depths,
                      const StereoCamera& camera, double max_depth = 0.0);

} // namespace pcl_semantic
