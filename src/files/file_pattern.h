// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Finds files in natural order by a shell pattern (`left-*.png`, with `*`, `?`,
 * `[...]` and backslash escapes). An existing path is taken literally: a file is
 * itself; a folder is all its files of these extensions except for hidden ones, two of
 * which may not differ only in their extension.
 * \throws BadInputException if there are none or a folder cannot be read */
std::vector<std::string> findFiles(const std::string& pattern,
                                   const std::vector<std::string>& extensions);

/** \brief The files of a folder whose names have an ending, in natural order. Empty if
 * there are none, or if the folder cannot be read. */
std::vector<std::string> filesEndingIn(const std::string& ending,
                                       const std::string& folder);

/** \brief Natural order: numbers by value, "frame2" before "frame10". */
bool naturalLess(const std::string& a, const std::string& b);

/** \brief The integers in a text, of any length, without leading zeros. */
std::vector<std::string> numbersIn(const std::string& text);

/** \brief The name of a file without its folder and extension; nuScenes has a double
 * one (".pcd.bin"). */
std::string frameNameOf(const std::string& path);

/** \brief The frame numbers of files whose names without extension are numbers
 * ("000012.pcd"). Empty if a name is no integer up to kMaxFrameNumber, such as a date
 * or timestamp.
 * \param[in] paths in natural order
 * \throws BadInputException if two have the same number */
std::vector<int> frameNumbersOf(const std::vector<std::string>& paths);

} // namespace pcl_semantic
