// SPDX-License-Identifier: BSD-3-Clause
#include "block_update.h"

#include <algorithm>
#include <limits>

namespace pcl_semantic {

namespace {

// Calls visit(place) for every bit that is set, in order.
template <typename Visit>
void
forEachBit(const std::uint64_t* words, Visit&& visit)
{
  for (std::size_t w = 0; w < CrossedVoxels::kWords; ++w)
    for (std::uint64_t bits = words[w]; bits != 0; bits &= bits - 1)
      visit(int(64 * w) + __builtin_ctzll(bits));
}

} // namespace

BlockUpdate::BlockUpdate(int classes, const MapParameters& parameters, const Scan& scan)
    : classes_(classes), occupancy_(parameters.fusion),
      per_ray_(parameters.fusion.per_ray_counting), voxel_size_(parameters.voxel_size),
      scan_(scan), measurement_(classes, parameters.fusion)
{}

std::size_t
BlockUpdate::run(const std::uint64_t* crossed, const RayHit* first, const RayHit* last,
                 VoxelBlock& block)
{
  block.changed = true;
  sortByPlace(first, last);
  if (!per_ray_) // else it has been updated ray by ray
    updateOccupancy(crossed, block);
  std::size_t hit_voxels = 0;
  std::size_t begin = 0;
  forEachBit(hit_.data(), [&](int place) {
    fuse(place, begin, end_[std::size_t(place)], block);
    begin = end_[std::size_t(place)];
    ++hit_voxels;
  });
  return hit_voxels;
}

void
BlockUpdate::sortByPlace(const RayHit* first, const RayHit* last)
{
  hit_.fill(0);
  for (const RayHit* hit = first; hit != last; ++hit) {
    std::uint64_t& word = hit_[hit->place >> 6];
    const std::uint64_t bit = std::uint64_t(1) << (hit->place & 63);
    end_[hit->place] = word & bit ? end_[hit->place] + 1 : 1;
    word |= bit;
  }
  std::uint32_t begin = 0;
  forEachBit(hit_.data(), [&](int place) {
    const std::uint32_t count = end_[std::size_t(place)];
    end_[std::size_t(place)] = begin;
    begin += count;
  });
  points_.resize(std::size_t(last - first));
  for (const RayHit* hit = first; hit != last; ++hit) {
    points_[end_[hit->place]++] = hit->point;
    // Neighbours in the map are none in the scan.
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
    if (missed == ~std::uint64_t(0)) // the loop that compilers make wide
      for (int i = 0; i < 64; ++i)
        occupancy_.miss(layer[i]);
    else
      for (std::uint64_t bits = missed; bits != 0; bits &= bits - 1)
        occupancy_.miss(layer[__builtin_ctzll(bits)]);
  }
  std::size_t begin = 0;
  forEachBit(hit_.data(), [&](int place) {
    const std::size_t end = end_[std::size_t(place)];
    occupancy_.hit(block.log_odds[std::size_t(place)], weightOf(begin, end));
    begin = end;
  });
}

// That of the surest point: their order does not matter.
float
BlockUpdate::weightOf(std::size_t begin, std::size_t end) const
{
  if (!scan_.deviations)
    return 1.0f;
  float least = std::numeric_limits<float>::max();
  for (std::size_t i = begin; i < end; ++i)
    least = std::min(least, (*scan_.deviations)[points_[i]]);
  return hitWeight(voxel_size_, least);
}

void
BlockUpdate::fuse(int place, std::size_t begin, std::size_t end, VoxelBlock& block)
{
  measurement_.clear();
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint32_t point = points_[i];
    if (!scan_.rgb.empty())
      measurement_.addColour(scan_.rgb[point]);
    if (scan_.distributions)
      measurement_.addDistribution(scan_.distributions->column(Eigen::Index(point)));
  }
  const int record = block.makeRecord(place, classes_);
  const bool labelled = measurement_.fuseInto(
      block.records[std::size_t(record)], block.measured.data() + record * classes_);
  // What was concluded from older measurements does not hold any more.
  if (labelled)
    std::fill_n(block.refined.begin() + record * classes_, classes_, 0.0f);
}

} // namespace pcl_semantic
