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

/** \brief readPcd() on the bytes of a file. \param[in] path for messages */
PcdTable decodePcd(const std::string& path, std::string_view file);

/** \brief The data of a `.pcd` file in rows of packed fields, padding included. Memory
 * is taken only for what the file can hold.
 * \throws BadInputException as readPcd() */
std::vector<std::uint8_t>
decodePcdAscii(const std::string& path, const PcdHeader& header, std::string_view file);

/** \brief As decodePcdAscii(), for both of the binary encodings. */
std::vector<std::uint8_t> decodePcdBinary(const std::string& path,
                                          const PcdHeader& header,
                                          std::string_view file);

/** \brief Unpacks LZF: a control byte c < 32 is followed by c + 1 bytes as they are;
 * any other repeats earlier ones: length (c >> 5) + 2, where 7 + 2 is lengthened by the
 * next byte, from (c & 31) * 256 + next byte + 1 bytes back.
 * \param[in] size of the result
 * \return whether \a packed is whole and gives exactly that many bytes */
bool unpackLzf(std::string_view packed, std::size_t size,
               std::vector<std::uint8_t>& result);

} // namespace pcl_semantic
