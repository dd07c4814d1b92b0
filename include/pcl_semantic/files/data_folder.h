// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Path of a data file of this project (label sets, networks, presets), relative
 * to the running program or this library: `share/pcl_semantic` if installed, `data` of
 * the source tree in a build.
 * \param[in] name "label_sets/kitti11.yaml"
 * \throws BadInputException if it does not exist */
std::string findDataFile(const std::string& name);

} // namespace pcl_semantic
