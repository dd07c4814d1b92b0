// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Columns and rows that an image file states in its header; 0 if it does not.
 */
struct StatedSize {
  std::uint64_t columns = 0, rows = 0;
};

/** \brief That of a PNG, JPEG or TIFF file (of its first image), without decoding it.
 */
StatedSize statedSize(const std::vector<std::uint8_t>& bytes);

/** \brief Makes sure that a file could hold what it states, before a decoder takes
 * memory for it: beyond 10^8 pixels no more than ten thousand a byte.
 * \param[in] path for the message
 * \throws BadInputException */
void requirePlausibleSize(const std::vector<std::uint8_t>& bytes,
                          const std::string& path);

} // namespace pcl_semantic
