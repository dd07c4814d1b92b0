// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/map/map_parameters.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <vector>

namespace pcl_semantic {

/** \brief Merges the same block of several maps, see mergeArchives();
 * it does not depend on their order. Refined distributions are left out where several
 * have hits: a CRF would no longer conclude them.
 *
 * \param[in] classes L */
VoxelBlock mergeBlocks(const std::vector<const VoxelBlock*>& blocks, int classes,
                       const FusionParameters& fusion);

} // namespace pcl_semantic
