// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/map_folder.h>

#include "core/fail.h"

#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/odometry/pose_source.h>

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
    if (!json.at("finished").get<bool>())
      badInput(path, ": the map is not finished");
    summary.voxel_size = json.at("voxel_size").get<double>();
    for (int axis = 0; axis < 3; ++axis)
      summary.origin[axis] = json.at("map_origin").at(std::size_t(axis)).get<double>();
    if (json.contains("frame_numbers"))
      summary.frames = json.at("frame_numbers").get<std::vector<int>>();
    if (json.contains("inputs") && json["inputs"].contains("sensor"))
      summary.sensor = json["inputs"]["sensor"].get<std::string>();
  }
  catch (const nlohmann::json::exception&) {
    badInput(path, ": is no summary of a map, expected finished, voxel_size and "
                   "map_origin");
  }
  if (!(summary.voxel_size > 0.0))
    badInput(path, ": voxel_size is ", summary.voxel_size, ", expected more than 0");
  return summary;
}

MapFolder
readMapFolder(const std::string& folder)
{
  MapFolder map;
  const MapSummary summary = readMapSummary(folder);
  if (!summary.frames)
    badInput(folder, "/summary.json: has no frame_numbers; is the map being made?");
  map.frames = *summary.frames;
  VoxelCloud& voxels = map.voxels;
  voxels.voxel_size = summary.voxel_size;
  voxels.origin = summary.origin;
  voxels.cloud = readLabelledCloud(folder + "/map.pcd").cloud;
  for (const auto& point : *voxels.cloud) {
    // The centres are rounded to single precision, far less than half a voxel.
    const Eigen::Vector3d centre =
        point.getVector3fMap().cast<double>() + voxels.origin;
    const Eigen::Array3d index = (centre.array() / voxels.voxel_size).floor();
    if (!(index.abs() <= kMaxVoxelIndex).all())
      badInput(folder, "/map.pcd: a point is no centre of a voxel");
    voxels.indices.push_back(index.cast<int>());
  }
  for (const Eigen::Isometry3d& pose : readKittiTrajectory(folder + "/trajectory.txt"))
    map.T_world_camera0.push_back(worldFromFirstCamera() * pose);
  for (const int frame : map.frames)
    if (frame < 0 || std::size_t(frame) >= map.T_world_camera0.size())
      badInput(folder, "/trajectory.txt: has no pose of frame ", frame);
  return map;
}

} // namespace pcl_semantic
