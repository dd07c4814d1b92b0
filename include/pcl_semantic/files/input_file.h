// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/parse_number.h>

#include <cstdint>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The bytes of a file. \throws BadInputException if it cannot be read */
std::vector<std::uint8_t> readBytes(const std::string& path);

/** \brief A line of a text file and its number, counted from 1. */
struct TextLine {
  std::string text;
  int number = 0;
};

/** \brief The lines of a text file without byte-order mark, carriage returns and
 * trailing blanks. \throws BadInputException if it cannot be read */
std::vector<TextLine> readLines(const std::string& path);

/** \brief "PATH line N", for messages. */
std::string atLine(const std::string& path, int line);

/** \brief Makes sure that a path is not that of a folder, a pipe or a device, whose
 * opening could wait for ever. \throws BadInputException */
void requireRegularFile(const std::string& path);

/** \brief Largest number of a frame: rows of trajectories are counted by it. Larger
 * numbers in the names of files are dates or time stamps. */
constexpr int kMaxFrameNumber = 999999;

/** \brief File name of a frame: six digits and an extension ("000012.png"). */
std::string frameFileName(int frame, const std::string& extension);

/** \brief A file of a folder that is named by its frame number. */
struct FrameFile {
  int frame = 0;
  std::string path;
};

/** \brief The files of a folder named by a number and one of the \a extensions
 * (".png"), in the order of their numbers; others are passed over.
 * \throws BadInputException if the folder cannot be read, two files have one number, or
 * one beyond kMaxFrameNumber */
std::vector<FrameFile> listFrameFiles(const std::string& folder,
                                      const std::vector<std::string>& extensions);

} // namespace pcl_semantic
