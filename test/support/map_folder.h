// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/odometry/pose_source.h>
#include <pcl_semantic/pipeline/map_folder.h>

#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief A finished map written by MappingOutput. */
struct MapFolder {
  VoxelCloud voxels;          ///< without distributions and observations
  std::vector<int> frames;    ///< numbers of the frames in the map
  Trajectory T_world_camera0; ///< row n belongs to frame n, KITTI's camera 0
};

/** \brief Reads map.pcd, trajectory.txt and summary.json of a folder. */
inline MapFolder
readMapFolder(const std::string& folder)
{
  MapFolder map;
  const MapSummary summary = readMapSummary(folder);
  map.frames = summary.frames.value();
  map.voxels.voxel_size = summary.voxel_size;
  map.voxels.origin = summary.origin;
  map.voxels.cloud = readLabelledCloud(folder + "/map.pcd").cloud;
  for (const auto& point : *map.voxels.cloud) {
    const Eigen::Vector3d position =
        point.getVector3fMap().cast<double>() + map.voxels.origin;
    map.voxels.indices.push_back(
        (position.array() / map.voxels.voxel_size).floor().cast<int>());
  }
  for (const Eigen::Isometry3d& pose : readKittiTrajectory(folder + "/trajectory.txt"))
    map.T_world_camera0.push_back(worldFromFirstCamera() * pose);
  return map;
}

} // namespace pcl_semantic
