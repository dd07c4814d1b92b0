// SPDX-License-Identifier: BSD-3-Clause
#include "free_space.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>

namespace pcl_semantic {

namespace {

// Measured, see doc/map.md.
constexpr double spared_voxels = 1.0;    // before every end
constexpr double spared_fraction = 0.03; // of the ray, if the surface is not level
constexpr double spared_layers = 2.0;    // above level ground, or below a ceiling
constexpr double most_for_layers = 0.25; // of the ray
constexpr int level_reach = 4;           // voxels above and below

// Bits of a column and its neighbours, in the layout of CrossedVoxels::layers().
std::uint64_t
columnsAround(int offset)
{
  const int x = offset & (kBlockEdge - 1), y = offset >> kBlockBits & (kBlockEdge - 1);
  std::uint64_t bits = 0;
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, kBlockEdge - 1); ++j)
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, kBlockEdge - 1); ++i)
      bits |= std::uint64_t(1) << (kBlockEdge * j + i);
  return bits;
}

} // namespace

bool
isLevel(const CrossedVoxels& hits, const VoxelIndex& voxel)
{
  const std::uint64_t columns = columnsAround(voxelInBlock(voxel));
  const auto isHit = [&](int z) {
    const VoxelIndex block = blockOf({voxel.x(), voxel.y(), z});
    return hits.contains(block) &&
           (hits.layers(hits.slotOf(block))[z & (kBlockEdge - 1)] & columns) != 0;
  };
  for (int distance = 2; distance <= level_reach; ++distance)
    if (isHit(voxel.z() - distance) || isHit(voxel.z() + distance))
      return false;
  return true;
}

double
FreeSpace::fraction(const VoxelIndex& end, double length)
{
  if (clearing_ != Clearing::careful)
    return 1.0;
  if (end != last_) { // neighbours in a scan often share a voxel
    last_ = end;
    last_is_level_ = isLevel(hits_, end);
  }
  const int layers = std::abs(end.z() - start_.z()); // between the sensor and the end
  const double spared =
      last_is_level_ ? std::min(spared_layers / std::max(layers, 1), most_for_layers)
                     : spared_fraction;
  const double before_end = spared_voxels * voxel_size_;
  return length > before_end ? std::max(1.0 - before_end / length - spared, 0.0) : 0.0;
}

} // namespace pcl_semantic
