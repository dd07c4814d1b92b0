// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/map_folder.h>

#include "core/fail.h"

#include <pcl_semantic/files/input_file.h>

#include <nlohmann/json.hpp>

namespace pcl_semantic {

MapSummary
readMapSummary(const std::string& folder)
{
  const std::string path = folder + "/summary.json";
  const std::vector<std::uint8_t> bytes = readBytes(path);
  MapSummary summary;
  try {
    const auto json = nlohmann::json::parse(bytes.begin(), bytes.end());
    summary.is_whole = json.at("finished").get<bool>();
    if (!summary.is_whole && !json.contains("voxel_size"))
      badInput(path, ": the map is not finished");
    summary.voxel_size = json.at("voxel_size").get<double>();
    for (int axis = 0; axis < 3; ++axis)
      summary.origin[axis] = json.at("map_origin").at(std::size_t(axis)).get<double>();
    if (json.contains("frame_numbers"))
      summary.frames = json.at("frame_numbers").get<std::vector<int>>();
  }
  catch (const nlohmann::json::exception&) {
    badInput(path, ": is no summary of a map, expected finished, voxel_size and "
                   "map_origin");
  }
  if (!(summary.voxel_size > 0.0))
    badInput(path, ": voxel_size is ", summary.voxel_size, ", expected more than 0");
  return summary;
}

} // namespace pcl_semantic
