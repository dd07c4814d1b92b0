// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Text for a terminal: control characters and those that change the direction
 * of a line, which a name from a file may hold, and bytes that are not UTF-8 appear as
 * \xNN.
 *
 * \param[in] keeps_lines line breaks stay */
std::string printable(const std::string& text, bool keeps_lines = false);

/** \brief JSON for a terminal: the same characters, which JSON may hold within strings,
 * appear as \uNNNN; its value is the same. */
std::string printableJson(const std::string& json);

} // namespace pcl_semantic
