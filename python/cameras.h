// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "arrays.h"

#include <pcl_semantic/core/stereo_camera.h>

#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace pcl_semantic::python {

/** \brief Reports the library's doubts by warnings.warn(). */
void warnOf(const std::vector<std::string>& doubts);

/** \brief A camera from fx, fy, cx, cy [px], baseline [m], width, height [px]. */
StereoCamera cameraOf(const std::vector<double>& numbers);

/** \brief An image from H x W or H x W x 3 values, red, green, blue. */
cv::Mat imageOf(const py::object& values, const StereoCamera& camera, const char* name);

/** \brief Refuses a forked process, where OpenCV's threads do not run. */
void requireNoFork();

/** \brief Binds read_camera() and pixel_features(). */
void bindCameras(py::module_& module);

} // namespace pcl_semantic::python
