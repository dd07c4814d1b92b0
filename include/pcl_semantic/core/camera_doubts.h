// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Warnings about a camera, one line each: a principal point far from the image
 * centre (as for images of half or double the size), and a focal length that is not in
 * pixels. Empty if the image size is unknown. */
std::vector<std::string> doubtsOf(const StereoCamera& camera);

/** \brief The same warnings.
 * \param[in] strict refuse the camera instead
 * \throws BadInputException with the first warning, if strict */
std::vector<std::string> doubtsOf(const StereoCamera& camera, bool strict);

} // namespace pcl_semantic
