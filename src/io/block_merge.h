// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/map/map_parameters.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <vector>

namespace pcl_semantic {

/** \brief Merges the same block of several maps, independent of their order; see
 * mergeArchives(). Refined distributions are dropped if several maps have hits, because
 * a CRF would give other results.
 *
 * \param[in] classes L */
VoxelBlock mergeBlocks(const std::vector<const VoxelBlock*>& blocks, int classes,
                       const FusionParameters& fusion);

} // namespace pcl_semantic
