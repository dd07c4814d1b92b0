// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <sstream>
#include <string>

namespace pcl_semantic {

/** \brief The text of an ASCII .pcd.
 * \param[in] fields names, separated by blanks; those of one letter are floats, others
 * unsigned, unless typed: "x:F8 intensity:F4"
 * \param[in] rows one point per line
 * \param[in] height more than 1 = organized */
inline std::string
asciiCloud(const std::string& fields, const std::string& rows, int height = 1,
           const std::string& viewpoint = "1 2 3 1 0 0 0")
{
  std::string names, sizes, types, counts;
  std::istringstream words(fields);
  for (std::string word; words >> word;) {
    if (word.find(':') == std::string::npos)
      word += word.size() == 1 ? ":F4" : ":U4";
    const std::size_t colon = word.find(':');
    names += " " + word.substr(0, colon);
    types += std::string(" ") + word[colon + 1];
    sizes += std::string(" ") + word[colon + 2];
    counts += " 1";
  }
  const auto points = std::count(rows.begin(), rows.end(), '\n');
  return "VERSION 0.7\nFIELDS" + names + "\nSIZE" + sizes + "\nTYPE" + types +
         "\nCOUNT" + counts + "\nWIDTH " + std::to_string(points / height) +
         "\nHEIGHT " + std::to_string(height) + "\nVIEWPOINT " + viewpoint +
         "\nPOINTS " + std::to_string(points) + "\nDATA ascii\n" + rows;
}

/** \brief The text of an ASCII .ply of points.
 * \param[in] properties names, of floats unless typed: "x int:label"
 * \param[in] rows one point per line */
inline std::string
asciiPly(const std::string& properties, const std::string& rows)
{
  std::string header = "ply\nformat ascii 1.0\nelement vertex " +
                       std::to_string(std::count(rows.begin(), rows.end(), '\n'));
  std::istringstream words(properties);
  for (std::string word; words >> word;) {
    std::replace(word.begin(), word.end(), ':', ' ');
    header += std::string("\nproperty ") +
              (word.find(' ') < word.size() ? "" : "float ") + word;
  }
  return header + "\nend_header\n" + rows;
}

} // namespace pcl_semantic
