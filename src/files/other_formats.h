// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <string>

namespace pcl_semantic {

/** \brief Refuses a cloud in an unsupported format and suggests a conversion command.
 * \throws BadInputException if the name of an existing file, or its first bytes, match
 * such a format */
PCL_SEMANTIC_EXPORT void refuseOtherFormats(const std::string& path);

} // namespace pcl_semantic
