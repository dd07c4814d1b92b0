// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/io/map_reader.h>
#include <pcl_semantic/things/map_objects.h>

#include <Eigen/Geometry>

#include <vector>

namespace pcl_semantic {

/** \brief The objects of a map and the motion of their voxels. */
struct PlacedObjects {
  MapObjects objects;
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity(); ///< [voxels]
};

/** \brief Merges the objects of maps, for a map of mergeArchives().
 *
 * Two still objects of different maps become one if they have the same label and share
 * voxels or have neighbouring ones (26 neighbours). An object joins at most one of each
 * map: the one with which it shares most. Objects are numbered from 1 in the order of
 * the maps and of their numbers. A voxel of several objects belongs to the first one;
 * an object that keeps none is left out. The result cannot be tracked further. */
MapObjects mergeObjects(const std::vector<PlacedObjects>& maps);

/** \brief Reads the occupied voxels of the blocks that an object reaches.
 * \throws BadInputException if the map is damaged */
VoxelCloud voxelsAround(const MapReader& map, const MapObject& object);

/** \brief Leaves out voxels that are not occupied with the label of their object, and
 * objects with fewer than MapObjects::min_voxels other ones. Numbers stay.
 * \throws BadInputException if the map is damaged */
void keepVisible(const MapReader& map, MapObjects& objects);

} // namespace pcl_semantic
