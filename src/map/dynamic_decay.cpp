// SPDX-License-Identifier: BSD-3-Clause
#include "dynamic_decay.h"

#include <pcl_semantic/map/block_reader.h>

#include <array>
#include <cmath>

namespace pcl_semantic {

void
decayDynamicVoxels(const LabelSet& label_set, const FusionParameters& fusion,
                   RayCaster::Grid& grid)
{
  const OccupancyUpdate update(fusion);
  const BlockReader reader(label_set.size(), fusion);
  const int units = static_cast<int>(std::lround(fusion.dynamic_decay / kLogOddsUnit));
  std::array<bool, 256> dynamic{};
  for (int label = 1; label <= label_set.size(); ++label)
    dynamic[std::size_t(label)] = label_set[Label(label)].dynamic;
#pragma omp parallel for schedule(dynamic, 1024)
  for (std::size_t slot = 0; slot < grid.slots(); ++slot) {
    VoxelBlock* const block = grid.at(slot).get();
    if (!block || block->records.empty())
      continue;
    for (int place = 0; place < kBlockVoxels; ++place)
      if (reader.isOccupied(*block, place) && dynamic[reader.label(*block, place)]) {
        update.decay(block->log_odds[std::size_t(place)], units);
        block->changed = true;
      }
  }
}

} // namespace pcl_semantic
