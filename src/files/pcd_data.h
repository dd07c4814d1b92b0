// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcd_header.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pcl_semantic {

inline std::string_view
textOf(const std::vector<std::uint8_t>& file)
{
  return {reinterpret_cast<const char*>(file.data()), file.size()};
}

/** \brief Decodes the data after a header into rows of fields, padding included.
 * Allocates only as much as the file can contain, and reuses \a file for binary data.
 * \throws BadInputException as readPcd() */
std::vector<std::uint8_t> decodeData(const std::string& path, const PcdHeader& header,
                                     std::vector<std::uint8_t> file);

} // namespace pcl_semantic
