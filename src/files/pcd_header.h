// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/cloud_file.h>

#include <cstddef>
#include <iosfwd>
#include <string>
#include <string_view>

namespace pcl_semantic {

enum class PcdEncoding { ascii, binary, binary_compressed };

struct PcdHeader {
  PcdTable table; ///< without data, but including padding fields
  PcdEncoding encoding = PcdEncoding::binary;
  std::size_t data_offset = 0; ///< of the first byte of the data in the file
  int data_line = 0;           ///< number of the line DATA, counted from 1
};

/** \brief Parses the header at the beginning of a file, see readPcd().
 * \throws BadInputException as readPcd() */
PcdHeader parsePcdHeader(const std::string& path, std::string_view file);

/** \brief Writes the header of writeCloudTable(), for callers that write the points
 * themselves.
 * \param[in] table its data are ignored */
void writePcdHeader(std::ostream& stream, const PcdTable& table);

/** \brief The next line from \a offset on, without carriage return; advances \a offset.
 */
std::string_view takeLine(std::string_view text, std::size_t& offset);

/** \brief Removes the next word from \a line and returns it; empty at its end. */
std::string_view takeWord(std::string_view& line);

} // namespace pcl_semantic
