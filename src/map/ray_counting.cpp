/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "ray_counting.h"

namespace pcl_semantic {

void
countRays(const RayCaster& caster, const FusionParameters& fusion,
          RayCaster::Grid& grid)
{
  const OccupancyUpdate update(fusion);
  const auto logOdds = [&](const VoxelIndex& voxel) -> StoredLogOdds* {
    VoxelBlock* const block = grid.find(blockOf(voxel));
    return block ? &block->log_odds[std::size_t(voxelInBlock(voxel))] : nullptr;
  };
  caster.forEachRay([&](const QuantizedPoint& start, const QuantizedPoint& end,
                        const VoxelIndex* hit) {
    traverseSegment(start, end, [&](const VoxelIndex& voxel) {
      StoredLogOdds* const crossed = logOdds(voxel);
      if (crossed && !(hit && voxel == *hit))
        update.miss(*crossed);
      return crossed != nullptr; // outside the window there are no blocks
    });
    if (hit)
      update.hit(*logOdds(*hit));
  });
}

} // namespace pcl_semantic
