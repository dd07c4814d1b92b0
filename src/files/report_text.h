// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/printable.h>

#include <nlohmann/json.hpp>

#include <string>

namespace pcl_semantic {

/** \brief A field of a CSV file, quoted if necessary (RFC 4180). */
inline std::string
csvField(const std::string& text)
{
  if (text.find_first_of(",\"\r\n") == std::string::npos)
    return text;
  std::string quoted = "\"";
  for (const char letter : text)
    quoted += letter == '"' ? "\"\"" : std::string(1, letter);
  return quoted + "\"";
}

/** \brief A JSON value as indented text with a trailing line break. Bytes that are not
 * UTF-8, which paths may contain, appear as U+FFFD. Control characters are escaped. */
template <typename Json>
std::string
jsonText(const Json& json)
{
  return printableJson(json.dump(2, ' ', false, Json::error_handler_t::replace)) + "\n";
}

} // namespace pcl_semantic
