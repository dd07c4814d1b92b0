// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/io/voxel_scene.h>

#include <string>
#include <utility>
#include <vector>

namespace pcl_semantic::tool {

/** \brief A finished map, its classes, and where the camera was. */
struct MapInput {
  VoxelScene scene;
  LabelSet label_set;
  Trajectory T_world_camera; ///< camera x right, y down, z forward; empty = not known
};

/** \brief Options about a map; empty or 0 = not given. */
struct MapHints {
  std::string label_set, trajectory;
  double voxel_size = 0.0; ///< [m]
  bool free_space = false; ///< wanted, where it is known: of an archive
};

/** \brief Reads a map: a folder that pcl_semantic_map has written, a labelled cloud,
 * or an archive.
 * \throws BadInputException */
MapInput readMap(const std::string& path, const MapHints& hints);

/** \brief A picture needs something. \param[in] path of the map
 * \throws BadInputException if it has no voxel that is occupied */
void requireVoxels(const std::string& path, const MapInput& map);

/** \brief The voxels of another map alone: in its own grid, or that of \a like if its
 * file says none. */
VoxelScene readOtherMap(const std::string& path, const MapHints& hints,
                        const VoxelScene& like);

/** \brief Camera poses in the frame of the scene's indices. */
Trajectory posesInScene(const MapInput& map);

} // namespace pcl_semantic::tool
