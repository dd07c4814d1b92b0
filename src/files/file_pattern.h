// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The files that match a pattern as the shell's (`left-*.png`, with `*`, `?`
 * and `[...]`, a backslash before what is meant as it is), in natural order. What is a
 * file as it stands is that file; a folder is all its files of these extensions but for
 * hidden ones, two of which may not differ in their extension alone.
 * \throws BadInputException if there are none or a folder cannot be read */
std::vector<std::string> findFiles(const std::string& pattern,
                                   const std::vector<std::string>& extensions);

/** \brief Natural order: numbers by value, "frame2" before "frame10". */
bool naturalLess(const std::string& a, const std::string& b);

/** \brief The whole numbers in a text, of any length, without leading zeros. */
std::vector<std::string> numbersIn(const std::string& text);

/** \brief The name of a file without its folder and extension, of which nuScenes has
 * two
 * (".pcd.bin"). */
std::string frameNameOf(const std::string& path);

/** \brief The frame numbers that the names of files are, without their extensions
 * ("000012.pcd"); empty if one is no whole number up to kMaxFrameNumber: dates and time
 * stamps are none.
 * \param[in] paths in natural order
 * \throws BadInputException if two have one number */
std::vector<int> frameNumbersOf(const std::vector<std::string>& paths);

} // namespace pcl_semantic
