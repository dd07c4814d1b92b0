// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <string>

namespace pcl_semantic {

/** \brief Refuses a cloud in a format that is not read: says which one it is and how to
 * convert it.
 * \throws BadInputException if the name of an existing file, or its first bytes, are of
 * such a format */
PCL_SEMANTIC_EXPORT void refuseOtherFormats(const std::string& path);

} // namespace pcl_semantic
