// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A file of the data that come with the module (label sets, networks, presets),
 * found beside the running program or this library: `share/pcl_semantic` when
 * installed, `data` of the source tree in a build. \param[in] name
 * "label_sets/kitti11.yaml" \throws BadInputException if it is not there */
std::string findDataFile(const std::string& name);

} // namespace pcl_semantic
