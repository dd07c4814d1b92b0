// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/live_camera.h>

#include <memory>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Whether the first pair lies in a folder; see openLiveFolder(). */
bool holdsPair(const std::string& folder);

/** \brief Opens a folder in KITTI's layout (calib.txt, image_2 and image_3 or image_0
 * and image_1) that another program fills: grabs the newest pair of which both images
 * are whole, which is a PNG that ends as one. What has a lower number came before it,
 * whole or not. Other files are passed over.
 * \throws BadInputException as KittiSequence, also if there is no pair yet */
std::unique_ptr<LiveCamera> openLiveFolder(const std::string& folder);

} // namespace pcl_semantic
