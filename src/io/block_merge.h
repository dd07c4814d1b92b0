// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/map/map_parameters.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <vector>

namespace pcl_semantic {

/** \brief Merges the blocks that several maps have at one index, see mergeArchives().
 * The result does not depend on the order of the maps.
 *
 * Refined distributions are kept only if a single map has hits in the block. A voxel of
 * a dynamic class that another map has seen free twice or more, and never hit, is free
 * (FusionParameters::free_dynamic).
 * \param[in] blocks one per map
 * \param[in] label_set with L classes
 * \param[in] fusion parameters of all maps */
VoxelBlock mergeBlocks(const std::vector<const VoxelBlock*>& blocks,
                       const LabelSet& label_set, const FusionParameters& fusion);

} // namespace pcl_semantic
