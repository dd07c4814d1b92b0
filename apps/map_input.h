// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/io/voxel_scene.h>
#include <pcl_semantic/things/object_summary.h>

#include <string>
#include <utility>
#include <vector>

namespace pcl_semantic::tool {

/** \brief A finished map, its classes, and its camera poses. */
struct MapInput {
  VoxelScene scene;
  LabelSet label_set;
  Trajectory T_world_camera; ///< camera x right, y down, z forward; empty = unknown
};

/** \brief Options about a map; empty or 0 = not given. */
struct MapHints {
  std::string label_set, trajectory;
  double voxel_size = 0.0; ///< [m]
  bool free_space = false; ///< read free space from an archive
};

/** \brief Reads a map: a folder of pcl_semantic_map, a labelled cloud, or an archive.
 * \throws BadInputException */
MapInput readMap(const std::string& path, const MapHints& hints);

/** \brief Reads the objects of a map; their boxes are in the world frame.
 * \param[in] path of the map
 * \param[in] file list of objects; empty: those of an archive, or objects.json of a map
 * folder, if there is one; "none": there are no objects
 * \throws BadInputException as readObjects() */
std::vector<ObjectSummary> readMapObjects(const std::string& path,
                                          const std::string& file,
                                          const LabelSet& label_set);

/** \brief Requires voxels, which an image needs. \param[in] path of the map
 * \throws BadInputException if no voxel is occupied */
void requireVoxels(const std::string& path, const MapInput& map);

/** \brief Reads only the voxels of another map: in its own grid, or in the grid of \a
 * like if its file has none. */
VoxelScene readOtherMap(const std::string& path, const MapHints& hints,
                        const VoxelScene& like);

/** \brief Camera poses in the frame of the scene's indices. */
Trajectory posesInScene(const MapInput& map);

} // namespace pcl_semantic::tool
