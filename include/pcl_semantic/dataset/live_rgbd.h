// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/live_camera.h>
#include <pcl_semantic/dataset/rgbd_sequence.h>

#include <memory>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Whether the folder contains its first frame; see openLiveRgbd(). */
bool holdsRgbdFrame(const std::string& folder);

/** \brief Opens a folder with `rgb/` and `depth/` that another program fills with PNG
 * images, whose names are the same number. Frames are selected as in openLiveFolder().
 * \param[in] calibration the camera's file; empty = RgbdFiles::intrinsics
 * \throws BadInputException, InvalidParameterException as RgbdSequence, also if there
 * is no frame yet */
std::unique_ptr<LiveCamera> openLiveRgbd(const RgbdFiles& files,
                                         const std::string& calibration);

} // namespace pcl_semantic
