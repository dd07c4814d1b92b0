// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <optional>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief What summary.json of a map folder says of the map. */
struct MapSummary {
  double voxel_size = 0.0;                          ///< [m]
  Eigen::Vector3d origin = Eigen::Vector3d::Zero(); ///< of the points, world frame [m]
  /// Numbers of the frames that are in the map; `live`, which is being made, names
  /// none.
  std::optional<std::vector<int>> frames;
  std::string sensor; ///< what took the clouds it was made of; empty = none did
};

/** \brief Reads summary.json of a folder.
 * \throws BadInputException if it is missing or damaged, or the map is not finished */
MapSummary readMapSummary(const std::string& folder);

/** \brief A finished map as MappingOutput left it. */
struct MapFolder {
  VoxelCloud voxels;          ///< without distributions and observations
  std::vector<int> frames;    ///< numbers of those that are in the map
  Trajectory T_world_camera0; ///< row n belongs to frame n, KITTI's camera 0
};

/** \brief Reads map.pcd, trajectory.txt and summary.json of a folder.
 * \throws BadInputException if one is missing or damaged, or the map is not finished */
MapFolder readMapFolder(const std::string& folder);

} // namespace pcl_semantic
