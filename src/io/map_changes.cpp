// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/map_changes.h>

#include "map/block_reader.h"
#include "moved_archive.h"

#include <pcl_semantic/map/voxel_set.h>

#include <algorithm>
#include <array>
#include <functional>

namespace pcl_semantic {

namespace {

constexpr std::size_t blocks_at_a_time = 1024;

void
forEachBlock(const MovedArchive& archive,
             const std::function<void(const VoxelIndex&, const VoxelBlock&)>& visit)
{
  const std::vector<VoxelIndex> indices = archive.indices();
  for (std::size_t begin = 0; begin < indices.size(); begin += blocks_at_a_time) {
    const std::size_t end = std::min(indices.size(), begin + blocks_at_a_time);
    const std::vector<VoxelIndex> some(indices.begin() + std::ptrdiff_t(begin),
                                       indices.begin() + std::ptrdiff_t(end));
    const auto blocks = archive.read(some);
    for (std::size_t i = 0; i < some.size(); ++i)
      if (blocks[i])
        visit(some[i], *blocks[i]);
  }
}

// The free and the occupied voxels of a map.
struct KnownVoxels {
  VoxelSet free, occupied;
};

KnownVoxels
knownIn(const MovedArchive& archive, const BlockReader& reader)
{
  std::vector<VoxelIndex> free, occupied;
  forEachBlock(archive, [&](const VoxelIndex& index, const VoxelBlock& block) {
    for (int offset = 0; offset < kBlockVoxels; ++offset) {
      const Occupancy occupancy = reader.occupancy(block, offset);
      if (occupancy != Occupancy::unknown)
        (occupancy == Occupancy::free ? free : occupied)
            .push_back(voxelAt(index, offset));
    }
  });
  return {VoxelSet(free), VoxelSet(occupied)};
}

// Blocks of a map reduced to the voxels that another map has observed as free,
// including all neighbours.
MapBlocks
seenFreeBy(const KnownVoxels& other, const MovedArchive& archive,
           const BlockReader& reader)
{
  VoxelSet::Reader free(other.free), occupied(other.occupied);
  const auto isContradicted = [&](const VoxelIndex& voxel) {
    if (!free.contains(voxel))
      return false;
    for (int i = 0; i < 27; ++i)
      if (occupied.contains(voxel + VoxelIndex(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)))
        return false;
    return true;
  };
  MapBlocks found;
  forEachBlock(archive, [&](const VoxelIndex& index, const VoxelBlock& block) {
    VoxelBlock rest = block;
    for (int offset = 0; offset < kBlockVoxels; ++offset)
      if (!reader.isOccupied(block, offset) || !isContradicted(voxelAt(index, offset)))
        rest.log_odds[std::size_t(offset)] = kUnknown;
    if (reader.countOccupied(rest) > 0)
      found.emplace_back(index, std::move(rest));
  });
  return found;
}

} // namespace

MapChanges
findChanges(const PlacedArchive& before, const PlacedArchive& after)
{
  const MovedArchive first(before.path, before.motion),
      second(after.path, after.motion);
  requireSameKind(first.archive(), second.archive());
  const ArchiveHeader& header = first.archive().header();
  const BlockReader reader(header.label_set.size(), header.parameters);
  const MapBlocks went = seenFreeBy(knownIn(second, reader), first, reader);
  const MapBlocks came = seenFreeBy(knownIn(first, reader), second, reader);
  MapChanges changes;
  std::vector<std::pair<VoxelIndex, const VoxelBlock*>> blocks;
  for (const auto& [index, block] : went) {
    blocks.emplace_back(index, &block);
    changes.went += reader.countOccupied(block);
  }
  for (const auto& [index, block] : came) {
    blocks.emplace_back(index, &block);
    changes.came += reader.countOccupied(block);
  }
  changes.voxels = reader.readAll(blocks, first.archive().state().cloud_origin);
  for (std::size_t i = 0; i < changes.voxels.size(); ++i) {
    pcl::PointXYZRGBL& point = (*changes.voxels.cloud)[i];
    point.r = i < changes.went ? 220 : 0;
    point.g = i < changes.went ? 0 : 180;
    point.b = 0;
  }
  return changes;
}

} // namespace pcl_semantic
