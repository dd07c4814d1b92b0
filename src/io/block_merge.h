// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/map/semantic_voxel.h>
#include <pcl_semantic/map/voxel_fusion.h>

#include <vector>

namespace pcl_semantic {

/** \brief What several maps know of the same block taken together, in whatever order:
 * log-odds and label logs are added and clamped, where what is unknown adds nothing;
 * colours and counts are summed. A refined distribution is kept where only one map has
 * hit the voxel; of several it is no longer what a CRF would conclude.
 * \param[in] classes L, of all of them */
VoxelBlock mergeBlocks(const std::vector<const VoxelBlock*>& blocks, int classes,
                       const FusionParameters& fusion);

} // namespace pcl_semantic
