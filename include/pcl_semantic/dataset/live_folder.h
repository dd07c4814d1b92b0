// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/live_camera.h>

#include <memory>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Whether the folder contains its first pair; see openLiveFolder(). */
bool holdsPair(const std::string& folder);

/** \brief Opens a folder in KITTI's layout (calib.txt, image_2 and image_3 or image_0
 * and image_1) that another program fills. Grabs the newest pair with two complete
 * images; a complete PNG ends with its end chunk. Lower numbers count as earlier pairs,
 * complete or not. Other files are ignored.
 * \throws BadInputException as KittiSequence, also if there is no pair yet */
std::unique_ptr<LiveCamera> openLiveFolder(const std::string& folder);

} // namespace pcl_semantic
