// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcd_header.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pcl_semantic {

/** \brief The bytes of a file as text. */
inline std::string_view
textOf(const std::vector<std::uint8_t>& file)
{
  return {reinterpret_cast<const char*>(file.data()), file.size()};
}

/** \brief The data behind a header in rows of fields, padding included. Memory is taken
 * only for what the file can hold, and none for binary data but that of \a file.
 * \throws BadInputException as readPcd() */
std::vector<std::uint8_t> decodeData(const std::string& path, const PcdHeader& header,
                                     std::vector<std::uint8_t> file);

} // namespace pcl_semantic
