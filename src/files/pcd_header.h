// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/pcd_table.h>

#include <string>
#include <string_view>

namespace pcl_semantic {

enum class PcdEncoding { ascii, binary, binary_compressed };

/** \brief What the header of a `.pcd` file says. */
struct PcdHeader {
  PcdTable table; ///< without data, but with the fields of padding
  PcdEncoding encoding = PcdEncoding::binary;
  std::size_t data_offset = 0; ///< of the first byte of the data in the file
  int data_line = 0;           ///< number of the line DATA, counted from 1
};

/** \brief Reads the header of a whole file.
 * \throws BadInputException as readPcd() */
PcdHeader parsePcdHeader(const std::string& path, std::string_view file);

/** \brief The next line from \a offset on, without carriage return; \a offset moves
 * behind it. */
std::string_view takeLine(std::string_view text, std::size_t& offset);

/** \brief The next word of \a line, which is cut off it; empty at its end. */
std::string_view takeWord(std::string_view& line);

} // namespace pcl_semantic
