// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/io/voxel_scene.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Translation that aligns a scene with an octree, whose voxels begin at
 * multiples of their size: at most half a voxel along each axis [m], 0 for maps of this
 * library. */
Eigen::Vector3d octreeShift(const VoxelScene& scene);

/** \brief Writes an OctoMap `.bt` (OcTree, occupied or free) in the world frame. Free
 * voxels are written if the scene has them; all others are unknown.
 * \throws BadInputException if the map exceeds the octree's range of 2^15 voxels on
 * each side of the world origin
 * \throws OutputException if the file cannot be written */
void writeOctree(const std::string& path, const VoxelScene& scene);

} // namespace pcl_semantic
