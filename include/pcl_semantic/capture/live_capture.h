// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/image_pair_sequence.h>
#include <pcl_semantic/dataset/live_camera.h>

#include <memory>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Whether a name denotes a camera or a stream: a number (`0`), a device
 * (`/dev/video0`) or an address (`rtsp://...`). Other names are files. */
bool isCapture(const std::string& name);

/** \brief Opens two cameras, streams or videos as a stereo camera. Videos are played at
 * the left one's frame rate. If left and right are equal, the images of one source
 * contain both sides next to each other.
 * \param[in] files names `left` and `right`, and the calibration; `times` is ignored
 * \throws BadInputException if a source cannot be opened or gives no image
 * \throws BadInputException if a video states no frame rate, the sizes of left and
 * right differ, or the calibration is invalid or for another image size */
std::unique_ptr<LiveCamera> openCaptures(const ImagePairFiles& files);

} // namespace pcl_semantic
