// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/io/voxel_scene.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief How far a scene had to be moved for an octree, whose voxels begin at
 * multiples of their size: at most half a voxel in each axis [m], 0 for a map whose
 * voxels do so in the world, as all of ours do. */
Eigen::Vector3d octreeShift(const VoxelScene& scene);

/** \brief Writes an OctoMap `.bt` (OcTree, occupied or free) in the world frame: what
 * is occupied, and free where the scene knows it; all else is unknown. \throws
 * BadInputException if the map goes beyond the 2^15 voxels to each side of the world's
 * origin that an octree has \throws OutputException */
void writeOctree(const std::string& path, const VoxelScene& scene);

} // namespace pcl_semantic
