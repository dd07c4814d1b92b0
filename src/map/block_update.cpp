// SPDX-License-Identifier: BSD-3-Clause
#include "block_update.h"
#include "ray_traversal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

// Calls visit(offset) for every bit that is set, in order.
template <typename Visit>
void
forEachBit(const std::uint64_t* words, Visit&& visit)
{
  for (std::size_t w = 0; w < CrossedVoxels::kWords; ++w)
    for (std::uint64_t bits = words[w]; bits != 0; bits &= bits - 1)
      visit(int(64 * w) + __builtin_ctzll(bits));
}

} // namespace

BlockUpdate::BlockUpdate(const LabelSet& label_set, const MapParameters& parameters,
                         const Scan& scan)
    : classes_(label_set.size()),
      dynamic_(classesWith(&LabelClass::dynamic, label_set)),
      occupies_dynamic_(parameters.fusion.occupy_dynamic),
      occupancy_(parameters.fusion), per_ray_(parameters.fusion.per_ray_counting),
      voxel_size_(parameters.voxel_size), label_deviations_(parameters, scan),
      scan_(scan), measurement_(classes_, parameters.fusion)
{}

std::size_t
BlockUpdate::run(const std::uint64_t* crossed, const RayHit* first, const RayHit* last,
                 VoxelBlock& block)
{
  block.changed = true;
  sortByOffset(first, last);
  if (!per_ray_) // otherwise updated ray by ray
    updateOccupancy(crossed, block);
  std::size_t hit_voxels = 0;
  std::size_t begin = 0;
  forEachBit(hit_.data(), [&](int offset) {
    fuse(offset, begin, end_[std::size_t(offset)], block);
    begin = end_[std::size_t(offset)];
    ++hit_voxels;
  });
  return hit_voxels;
}

void
BlockUpdate::sortByOffset(const RayHit* first, const RayHit* last)
{
  hit_.fill(0);
  for (const RayHit* hit = first; hit != last; ++hit) {
    std::uint64_t& word = hit_[hit->offset >> 6];
    const std::uint64_t bit = std::uint64_t(1) << (hit->offset & 63);
    end_[hit->offset] = word & bit ? end_[hit->offset] + 1 : 1;
    word |= bit;
  }
  std::uint32_t begin = 0;
  forEachBit(hit_.data(), [&](int offset) {
    const std::uint32_t count = end_[std::size_t(offset)];
    end_[std::size_t(offset)] = begin;
    begin += count;
  });
  hits_.resize(std::size_t(last - first));
  for (const RayHit* hit = first; hit != last; ++hit) {
    hits_[end_[hit->offset]++] = *hit;
    // Voxels that are adjacent in the map are scattered in the scan.
    if (!scan_.rgb.empty())
      __builtin_prefetch(scan_.rgb.address(hit->point));
    if (scan_.distributions)
      __builtin_prefetch(scan_.distributions->column(Eigen::Index(hit->point)));
  }
}

void
BlockUpdate::updateOccupancy(const std::uint64_t* crossed, VoxelBlock& block) const
{
  for (std::size_t w = 0; w < CrossedVoxels::kWords; ++w) {
    const std::uint64_t missed = crossed[w] & ~hit_[w];
    StoredLogOdds* const layer = block.log_odds.data() + 64 * w;
    if (missed == ~std::uint64_t(0)) // vectorised loop
      for (int i = 0; i < 64; ++i)
        occupancy_.miss(layer[i]);
    else
      for (std::uint64_t bits = missed; bits != 0; bits &= bits - 1)
        occupancy_.miss(layer[__builtin_ctzll(bits)]);
  }
  std::size_t begin = 0;
  forEachBit(hit_.data(), [&](int offset) {
    const std::size_t end = end_[std::size_t(offset)];
    occupancy_.hit(block.log_odds[std::size_t(offset)], weightOf(begin, end));
    begin = end;
  });
}

// Weight of the most certain point, because the order of points must not matter.
float
BlockUpdate::weightOf(std::size_t begin, std::size_t end) const
{
  if (!scan_.deviations)
    return 1.0f;
  float least = std::numeric_limits<float>::max();
  for (std::size_t i = begin; i < end; ++i)
    least = std::min(least, (*scan_.deviations)[hits_[i].point]);
  return hitWeight(voxel_size_, least);
}

void
BlockUpdate::fuse(int offset, std::size_t begin, std::size_t end, VoxelBlock& block)
{
  measurement_.clear();
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint32_t point = hits_[i].point;
    measurement_.addPosition(hits_[i].position);
    if (!scan_.rgb.empty())
      measurement_.addColour(scan_.rgb[point]);
    if (scan_.distributions)
      measurement_.addDistribution(scan_.distributions->column(Eigen::Index(point)),
                                   label_deviations_.of(point));
  }
  const int record = block.makeRecord(offset, classes_);
  const bool labelled = measurement_.fuseInto(
      block.records[std::size_t(record)], block.measured.data() + record * classes_);
  // The refined distribution came from older measurements.
  if (labelled)
    std::fill_n(block.refined.begin() + record * classes_, classes_, 0.0f);
  StoredLogOdds& log_odds = block.log_odds[std::size_t(offset)];
  if (labelled && occupies_dynamic_ && !occupancy_.isOccupied(log_odds) &&
      dynamic_[measurement_.mapLabel()])
    occupancy_.setOccupied(log_odds);
}

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
      const auto offset = std::uint32_t(voxelInBlock(voxel));
      if (!hit || hit->slot != slot || hit->hit.offset != offset)
        update.miss(grid.at(slot)->log_odds[offset]);
      return true;
    });
    if (!hit)
      return;
    const float deviation = scan.deviations ? (*scan.deviations)[hit->hit.point] : 0.0f;
    update.hit(grid.at(hit->slot)->log_odds[hit->hit.offset],
               hitWeight(parameters.voxel_size, deviation));
  });
}

} // namespace pcl_semantic
