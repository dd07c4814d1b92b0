// SPDX-License-Identifier: BSD-3-Clause
#include "core/fail.h"

#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/odometry/pose_source.h>
#include <pcl_semantic/pipeline/map_folder.h>

#include <nlohmann/json.hpp>

namespace pcl_semantic {

namespace {

// What of the summary is needed.
void
readSummary(const std::string& path, MapFolder& map)
{
  const std::vector<std::uint8_t> bytes = readBytes(path);
  const auto summary =
      nlohmann::json::parse(bytes.begin(), bytes.end(), nullptr, false);
  try {
    if (!summary.at("finished").get<bool>())
      badInput(path, ": the map is not finished");
    map.frames = summary.at("frame_numbers").get<std::vector<int>>();
    map.voxels.voxel_size = summary.at("voxel_size").get<double>();
    const auto origin = summary.at("map_origin").get<std::vector<double>>();
    map.voxels.origin << origin.at(0), origin.at(1), origin.at(2);
  }
  catch (const nlohmann::json::exception&) {
    badInput(path, ": is no summary of a map");
  }
  catch (const std::out_of_range&) {
    badInput(path, ": map_origin has no three numbers");
  }
  if (!(map.voxels.voxel_size > 0.0))
    badInput(path, ": voxel_size is ", map.voxels.voxel_size, ", expected more than 0");
}

} // namespace

MapFolder
readMapFolder(const std::string& folder)
{
  MapFolder map;
  readSummary(folder + "/summary.json", map);
  VoxelCloud& voxels = map.voxels;
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
