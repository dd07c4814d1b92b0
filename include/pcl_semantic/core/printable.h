// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Text for a terminal: control characters, also those that a name from a file
 * holds to move the cursor, and bytes that are not UTF-8 appear as \xNN.
 *
 * \param[in] keeps_lines line breaks stay */
std::string printable(const std::string& text, bool keeps_lines = false);

} // namespace pcl_semantic
