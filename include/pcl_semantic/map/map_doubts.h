// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/map/map_parameters.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Warnings about valid but unlikely parameters, one line each: lengths that
 * look like centimetres or millimetres. */
std::vector<std::string> doubtsOf(const MapParameters& parameters);

} // namespace pcl_semantic
