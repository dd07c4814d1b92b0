// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/config_parameter.h>
#include <pcl_semantic/core/export.h>

#include <map>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The values of a run's description, by name. */
std::map<std::string, std::string> runValues(const std::string& description);

/** \brief Sets the parameters that a run's description names; the others keep their
 * values. \throws BadInputException if a value cannot be */
void setFromRun(const std::map<std::string, std::string>& values,
                ConfigParameters parameters);

} // namespace pcl_semantic
