// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcd_header.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pcl_semantic {

/** \brief Bytes that may follow the data of a binary file: PCL pads the last page with
 * zeros, and pages have up to 64 KiB. */
constexpr std::size_t kMaxBehindData = 65536;

/** \brief Bytes of the data of a binary file.
 * \param[in] available bytes behind the header
 * \throws BadInputException if there are fewer */
std::size_t binarySize(const std::string& path, const PcdTable& table,
                       std::size_t available);

/** \brief Checks the bytes behind the data.
 * \param[in] size of them
 * \param[in] first of them, up to kMaxBehindData
 * \throws BadInputException unless they are up to kMaxBehindData zeros */
void checkBehindData(const std::string& path, std::size_t size, std::string_view first);

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
