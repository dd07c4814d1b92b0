// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <sstream>
#include <string>

namespace pcl_semantic {

/** \brief The text of an ASCII .pcd.
 * \param[in] fields names, separated by blanks; those of one letter are floats, others
 * unsigned
 * \param[in] rows one point per line
 * \param[in] height more than 1 = organized */
inline std::string
asciiCloud(const std::string& fields, const std::string& rows, int height = 1)
{
  std::string sizes, types, counts;
  std::istringstream words(fields);
  for (std::string word; words >> word;) {
    sizes += " 4";
    types += word.size() == 1 ? " F" : " U";
    counts += " 1";
  }
  const auto points = std::count(rows.begin(), rows.end(), '\n');
  return "VERSION 0.7\nFIELDS " + fields + "\nSIZE" + sizes + "\nTYPE" + types +
         "\nCOUNT" + counts + "\nWIDTH " + std::to_string(points / height) +
         "\nHEIGHT " + std::to_string(height) + "\nVIEWPOINT 1 2 3 1 0 0 0\nPOINTS " +
         std::to_string(points) + "\nDATA ascii\n" + rows;
}

} // namespace pcl_semantic
