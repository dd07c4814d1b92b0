// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <string>
#include <string_view>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Parses \a text, which must be one number in the C locale.
 * \throws BadInputException for any other text; its message begins with \a where */
double parseNumber(const std::string& text, const std::string& where);

/** \brief Parses the blank-separated finite numbers of a line.
 * \throws BadInputException for any other text; its message begins with \a where */
std::vector<double> parseNumbers(const std::string& text, const std::string& where);

/** \brief An excerpt of a file for a message: quoted, short and printable. */
std::string inQuotes(std::string_view text);

} // namespace pcl_semantic
