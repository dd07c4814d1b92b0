// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/cloud_file.h>

#include <cstdint>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

namespace pcl_semantic {

/** \brief Reads a `.pcd` file: ascii, binary or binary_compressed, fields of any name,
 * order and type, as PCL 1.13 and others write them. PCL's own reader crashes on an
 * empty file and returns success on garbage; this one believes nothing.
 *
 * The header's lines may come in any order before DATA, each once; WIDTH x HEIGHT has
 * to be POINTS. Fields called `_` are PCL's padding: any number of them, and dropped;
 * other names are unique. In ascii a point is a line; nan and inf are floats, a number
 * its type cannot hold is refused. Behind binary data there may be zeros, with which
 * PCL fills the last page.
 * \throws BadInputException that names the file, the line where there is one, and what
 * was expected */
PcdTable readPcd(const std::string& path);

/** \brief readPcd() on the bytes of a file. \param[in] path for messages */
PcdTable decodePcd(const std::string& path, std::string_view file);

/** \brief The header of the files that writeCloudTable() writes, for those who write
 * the points themselves. \param[in] table its data do not matter */
void writePcdHeader(std::ostream& stream, const PcdTable& table);

enum class PcdEncoding { ascii, binary, binary_compressed };

/** \brief What the header of a `.pcd` file says, or that of a `.ply` file. */
struct PcdHeader {
  PcdTable table; ///< without data, but with the fields of padding
  PcdEncoding encoding = PcdEncoding::binary;
  std::size_t data_offset = 0; ///< of the first byte of the data in the file
  int data_line = 0;           ///< number of the line DATA, counted from 1
};

/** \brief The data behind a header in rows of packed fields, padding included. Memory
 * is taken only for what the file can hold.
 * \throws BadInputException as readPcd() */
std::vector<std::uint8_t> decodeData(const std::string& path, const PcdHeader& header,
                                     std::string_view file);

/** \brief The next line from \a offset on, without carriage return; \a offset moves
 * behind it. */
std::string_view takeLine(std::string_view text, std::size_t& offset);

/** \brief The next word of \a line, which is cut off it; empty at its end. */
std::string_view takeWord(std::string_view& line);

} // namespace pcl_semantic
