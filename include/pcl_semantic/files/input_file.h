// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/parse_number.h>

#include <cstdint>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Reads the bytes of a file. \throws BadInputException if it cannot be read */
std::vector<std::uint8_t> readBytes(const std::string& path);

/** \brief A line of a text file and its number, counted from 1. */
struct TextLine {
  std::string text;
  int number = 0;
};

/** \brief Reads the lines of a text file without byte-order mark, carriage returns and
 * trailing blanks. \throws BadInputException if it cannot be read */
std::vector<TextLine> readLines(const std::string& path);

/** \brief Formats "PATH line N", for messages. */
std::string atLine(const std::string& path, int line);

/** \brief Requires a regular file, because opening a pipe or a device could block
 * forever.
 * \throws BadInputException if the path is a folder, pipe or device, or does not exist
 */
void requireRegularFile(const std::string& path);

/** \brief Largest frame number. It limits the rows of trajectories; larger numbers in
 * file names are dates or timestamps. */
constexpr int kMaxFrameNumber = 999999;

/** \brief File name of a frame: six digits and an extension ("000012.png"). */
std::string frameFileName(int frame, const std::string& extension);

/** \brief A file named by its frame number. */
struct FrameFile {
  int frame = 0;
  std::string path;
};

/** \brief Lists the files of a folder that are named by a number and one of the \a
 * extensions (".png"), in the order of their numbers; other files are ignored.
 * \throws BadInputException if the folder cannot be read, two files have the same
 * number, or a number exceeds kMaxFrameNumber */
std::vector<FrameFile> listFrameFiles(const std::string& folder,
                                      const std::vector<std::string>& extensions);

} // namespace pcl_semantic
