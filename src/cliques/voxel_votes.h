// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/cliques/depth_jumps.h>
#include <pcl_semantic/core/voxel_index.h>

#include <Eigen/Geometry>

#include <vector>

namespace pcl_semantic {

/** \brief The part that most of the pixels in each voxel belong to; of equal numbers
 * the lowest. Pixels fall in voxels as SemanticVoxelMap::integrate puts them there.
 * \param[in] cloud organized, camera frame [m]
 * \param[in] parts of its pixels
 * \param[in] voxels global indices; one may be there several times
 * \return one number a voxel; -1 = no pixel */
std::vector<int> partsOfVoxels(const CliqueGenerator::Cloud& cloud,
                               const SurfaceParts& parts,
                               const Eigen::Isometry3d& T_world_camera,
                               const std::vector<VoxelIndex>& voxels,
                               double voxel_size);

} // namespace pcl_semantic
