// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pcl_semantic {

/** \brief A field of a CSV file; quoted if it has to be (RFC 4180). */
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

} // namespace pcl_semantic
