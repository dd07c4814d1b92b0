// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Image size in the header of a file; 0 if unknown. */
struct StatedSize {
  std::uint64_t columns = 0, rows = 0;
};

/** \brief Reads the size of a PNG, JPEG or TIFF file (of its first image) without
 * decoding. */
StatedSize statedSize(const std::vector<std::uint8_t>& bytes);

/** \brief Checks before decoding that a file could contain its stated size: images of
 * more than 10^8 pixels have at most ten thousand pixels per byte.
 * \param[in] path for the message
 * \throws BadInputException */
void requirePlausibleSize(const std::vector<std::uint8_t>& bytes,
                          const std::string& path);

} // namespace pcl_semantic
