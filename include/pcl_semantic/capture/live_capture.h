// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/image_pair_sequence.h>
#include <pcl_semantic/dataset/live_camera.h>

#include <memory>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Whether a name is that of a camera or a stream instead of a file: a number
 * (`0`), a device (`/dev/video0`) or an address (`rtsp://...`). */
bool isCapture(const std::string& name);

/** \brief Opens two cameras or streams; two videos, which are played at their own rate;
 * or, if left and right are the same, one whose images have both sides next to each
 * other.
 * \param[in] files `left` and `right` by name, and the calibration; `times` is not used
 * \throws BadInputException if one cannot be opened, gives no image, both differ in
 * size, or the calibration does not fit */
std::unique_ptr<LiveCamera> openCaptures(const ImagePairFiles& files);

} // namespace pcl_semantic
