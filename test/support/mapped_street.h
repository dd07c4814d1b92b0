// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/tiny_street.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

namespace pcl_semantic {

/** \brief Maps a street with options; the run has to succeed and to print the
 * four lines that name its results, nothing else. */
inline void
mapStreet(const std::string& street, const std::string& output,
          const std::string& options)
{
  const ToolResult result =
      runTool(mapOf(street) + " --output " + output + " " + options);
  EXPECT_EQ(result.code, 0) << result.text;
  EXPECT_EQ(std::count(result.text.begin(), result.text.end(), '\n'), 4) << result.text;
}

/** \brief All files below a folder, without its own path. */
inline std::set<std::string>
filesIn(const std::string& folder)
{
  std::set<std::string> files;
  for (const std::filesystem::directory_entry& entry :
       std::filesystem::recursive_directory_iterator(folder))
    if (!entry.is_directory())
      files.insert(std::filesystem::relative(entry.path(), folder).string());
  return files;
}

/** \brief The files that a map of these frames consists of. */
inline std::set<std::string>
filesOfMap(const std::vector<std::string>& frames)
{
  std::set<std::string> files = {"map.pcd",        "map_classes.pcd", "top_view.png",
                                 "trajectory.txt", "summary.json",    "label_set.yaml"};
  for (const char* folder :
       {"labels/", "labels_at_depth/", "network_labels/", "final_labels/", "overlay/"})
    for (const std::string& frame : frames)
      files.insert(folder + frame + ".png");
  return files;
}

inline nlohmann::json
readJson(const std::string& path)
{
  return nlohmann::json::parse(bytesOf(path));
}

} // namespace pcl_semantic
