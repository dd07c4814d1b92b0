// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

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
