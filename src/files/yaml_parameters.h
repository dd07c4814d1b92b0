// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "yaml_config.h"

#include <pcl_semantic/core/config_parameter.h>
#include <pcl_semantic/core/export.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Sets the parameters that a mapping names; the others keep their values.
 * \throws BadInputException with file and line, at a removed parameter too */
void setParameters(const YamlMap& file, ConfigParameters parameters);

} // namespace pcl_semantic
