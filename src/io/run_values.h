// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/config_parameter.h>
#include <pcl_semantic/core/export.h>

#include <map>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

std::map<std::string, std::string> runValues(const std::string& description);

/** \brief Sets the parameters in a run's description; the others keep their values.
 * \throws BadInputException if a value is invalid */
void setFromRun(const std::map<std::string, std::string>& values,
                ConfigParameters parameters);

} // namespace pcl_semantic
