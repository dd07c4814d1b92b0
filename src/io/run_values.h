// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <map>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The values of a run's description, by name. */
std::map<std::string, std::string> runValues(const std::string& description);

} // namespace pcl_semantic
