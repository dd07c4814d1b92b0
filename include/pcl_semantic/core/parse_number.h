// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <string>
#include <string_view>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A number in the C locale; the whole of \a text must be one.
 * \throws BadInputException with \a where in front */
double parseNumber(const std::string& text, const std::string& where);

/** \brief The blank-separated finite numbers of a line.
 * \throws BadInputException with \a where in front */
std::vector<double> parseNumbers(const std::string& text, const std::string& where);

/** \brief A piece of a file for a message: in quotes, short and printable. */
std::string inQuotes(std::string_view text);

} // namespace pcl_semantic
