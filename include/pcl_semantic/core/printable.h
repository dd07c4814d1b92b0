// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Text that is safe to print on a terminal. Control characters, characters that
 * change the text direction, and bytes that are not UTF-8 appear as \xNN.
 *
 * \param[in] keeps_lines line breaks stay */
std::string printable(const std::string& text, bool keeps_lines = false);

/** \brief JSON that is safe to print on a terminal: the same characters, which JSON
 * allows within strings, appear as \uNNNN. The JSON value is unchanged. */
std::string printableJson(const std::string& json);

} // namespace pcl_semantic
