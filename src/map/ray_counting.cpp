// SPDX-License-Identifier: BSD-3-Clause
#include "ray_counting.h"

namespace pcl_semantic {

void
countRays(const RayCaster& caster, const MapParameters& parameters, const Scan& scan,
          RayCaster::Grid& grid)
{
  const OccupancyUpdate update(parameters.fusion);
  caster.forEachRay([&](const QuantizedPoint& start, const QuantizedPoint& end,
                        const RayCaster::SlotHit* hit) {
    traverseSegment(start, end, [&](const VoxelIndex& voxel) {
      const VoxelIndex index = blockOf(voxel);
      if (!grid.contains(index))
        return false;
      const std::size_t slot = grid.slotOf(index);
      const auto place = std::uint32_t(voxelInBlock(voxel));
      if (!hit || hit->slot != slot || hit->hit.place != place)
        update.miss(grid.at(slot)->log_odds[place]);
      return true;
    });
    if (!hit)
      return;
    const float deviation = scan.deviations ? (*scan.deviations)[hit->hit.point] : 0.0f;
    update.hit(grid.at(hit->slot)->log_odds[hit->hit.place],
               hitWeight(parameters.voxel_size, deviation));
  });
}

} // namespace pcl_semantic
