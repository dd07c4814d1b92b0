// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/tiny_street.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

namespace pcl_semantic {

/** \brief Maps a sequence with options; the run must succeed and print exactly the
 * lines with its results. */
inline void
mapStreet(const std::string& street, const std::string& output,
          const std::string& options)
{
  const ToolResult result =
      runTool(mapOf(street) + " --output " + output + " " + options);
  EXPECT_EQ(result.code, 0) << result.text;
  const bool has_objects = std::filesystem::exists(output + "/objects.json");
  const bool has_planes = std::filesystem::exists(output + "/planes.json");
  EXPECT_EQ(std::count(result.text.begin(), result.text.end(), '\n'),
            4 + has_objects + has_planes)
      << result.text;
}

/** \brief All files below a folder, as relative paths. */
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

/** \brief The files of a map with these frames. */
inline std::set<std::string>
filesOfMap(const std::vector<std::string>& frames)
{
  std::set<std::string> files = {"map.pcd",        "map_classes.pcd", "top_view.png",
                                 "trajectory.txt", "summary.json",    "label_set.yaml",
                                 "objects.json",   "boxes.ply",       "planes.json",
                                 "planes.ply"};
  for (const char* folder :
       {"labels/", "labels_at_depth/", "network_labels/", "final_labels/", "overlay/"})
    for (const std::string& frame : frames)
      files.insert(folder + frame + ".png");
  return files;
}

/** \brief EXPECTs the same files in two folders of a map, except for the times. */
inline void
expectSameMaps(const std::string& a, const std::string& b)
{
  EXPECT_EQ(filesIn(a), filesIn(b));
  for (const std::string& file : filesIn(a))
    EXPECT_TRUE(file == "summary.json" ||
                bytesOf(a + "/" + file) == bytesOf(b + "/" + file))
        << file;
}

inline nlohmann::json
readJson(const std::string& path)
{
  return nlohmann::json::parse(bytesOf(path));
}

} // namespace pcl_semantic
