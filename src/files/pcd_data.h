// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcd_header.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pcl_semantic {

/** \brief The data behind a header in rows of packed fields, padding included. Memory
 * is taken only for what the file can hold.
 * \throws BadInputException as readPcd() */
std::vector<std::uint8_t> decodeData(const std::string& path, const PcdHeader& header,
                                     std::string_view file);

} // namespace pcl_semantic
