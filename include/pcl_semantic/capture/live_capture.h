// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/image_pair_sequence.h>
#include <pcl_semantic/dataset/live_camera.h>

#include <memory>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Whether a name is a camera or a stream, not a file: a number (`0`), a device
 * (`/dev/video0`) or an address (`rtsp://...`). */
bool isCapture(const std::string& name);

/** \brief Opens two cameras or streams, two videos, which are played at their frame
 * rate, or, if left and right are equal, one source whose images contain both sides
 * next to each other.
 * \param[in] files names `left` and `right`, and the calibration; `times` is ignored
 * \throws BadInputException if a source cannot be opened or gives no image, the sizes
 * of left and right differ, or the calibration does not fit */
std::unique_ptr<LiveCamera> openCaptures(const ImagePairFiles& files);

} // namespace pcl_semantic
