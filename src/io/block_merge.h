// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/map/map_parameters.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <vector>

namespace pcl_semantic {

/** \brief Merges the blocks that several maps have at one index, see mergeArchives().
 * The result does not depend on the order of the maps.
 *
 * Refined distributions are kept only if a single map has hits in the block.
 * \param[in] blocks one per map
 * \param[in] classes number of classes L
 * \param[in] fusion parameters of all maps */
VoxelBlock mergeBlocks(const std::vector<const VoxelBlock*>& blocks, int classes,
                       const FusionParameters& fusion);

} // namespace pcl_semantic
