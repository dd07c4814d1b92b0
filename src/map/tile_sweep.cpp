/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "tile_sweep.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace pcl_semantic {

namespace {

// Bundles are taken apart where they become wider than this [voxels].
constexpr float widest = 1.0f;

// What has ended is removed now and then only: that costs more than to pass over it.
constexpr int groups_between_cleanings = 4;

// The widest bundles that are still narrow enough at a distance; -1: rays.
int
levelAt(float distance)
{
  int level = RayTile::kLevels - 1;
  while (level >= 0 && distance * RayTile::widthOf(level) > widest)
    --level;
  return level;
}

// A slope, a distance, their product, its sum with the start and that less a half are
// each rounded: at most five halves of the last place of the distance, 2^-23 of it.
float
marginAt(float distance)
{
  return (distance + 2.0f) * 0x1p-21f;
}

float
inVoxel(std::int64_t coordinate)
{
  constexpr std::int64_t edge = std::int64_t(1) << kQuantizationBits;
  return float(coordinate & (edge - 1)) / float(edge);
}

// Cells between two slopes, at distances from near to far, and one more on each side.
std::pair<int, int>
cellsBetween(float low, float high, float start, float near, float far)
{
  return {int(std::floor(start + std::min(low * near, low * far))) - 1,
          int(std::floor(start + std::max(high * near, high * far))) + 1};
}

} // namespace

TileSweep::TileSweep(SimdTier tier, const QuantizedPoint& start,
                     const std::vector<RayDelta>& ends, CrossedVoxels& crossed)
    : loops_(kernels::slabCrossing(tier)), start_(start), start_voxel_(voxelOf(start)),
      ends_(ends), crossed_(crossed)
{}

void
TileSweep::run(int face, const DirectedRay* const* rays, std::size_t count)
{
  axes_ = FaceAxes(face);
  const float inside = inVoxel(start_[axes_.along]);
  to_first_side_ = axes_.step > 0 ? 1.0f - inside : inside;
  tile_.set(rays, count);
  level_ = RayTile::kLevels; // none yet
  const int longest = tile_.all().longest;
  for (Group group{0, 0, 0}; group.first <= longest; group.first = group.last + 1) {
    const int voxel = start_voxel_[axes_.along] + axes_.step * group.first;
    const int layer = voxel & (kBlockEdge - 1);
    group.block = voxel >> kBlockBits;
    group.last = group.first + (axes_.step > 0 ? kBlockEdge - 1 - layer : layer);
    if (!beginGroup(group))
      return; // the window is convex: rays that have left it do not come back
    group.last = std::min(group.last, longest);
    if (level_ >= 0)
      for (int slab = group.first; slab <= group.last; ++slab)
        crossBundles(viewOf(slab), active_, level_);
    else
      crossAllRays(group);
    buffer_.flush(group.block, crossed_);
  }
}

bool
TileSweep::beginGroup(const Group& group)
{
  if (group.block < crossed_.firstBlock(axes_.along) ||
      group.block > crossed_.lastBlock(axes_.along))
    return false;
  const RayBundle& all = tile_.all();
  const float near = enterDistance(group.first);
  const float far = to_first_side_ + float(group.last);
  const auto clipped = [&](std::pair<int, int> cells, int axis) {
    const int low = crossed_.firstBlock(axis) * kBlockEdge - start_voxel_[axis];
    const int high =
        crossed_.lastBlock(axis) * kBlockEdge + kBlockEdge - 1 - start_voxel_[axis];
    return std::pair<int, int>(std::max(cells.first, low),
                               std::min(cells.second, high));
  };
  const auto rows = clipped(
      cellsBetween(all.row_low, all.row_high, inVoxel(start_[axes_.row]), near, far),
      axes_.row);
  const auto columns = clipped(cellsBetween(all.column_low, all.column_high,
                                            inVoxel(start_[axes_.column]), near, far),
                               axes_.column);
  if (rows.first > rows.second || columns.first > columns.second)
    return false;
  buffer_.begin(start_voxel_, axes_,
                {rows.first, rows.second, columns.first, columns.second});

  const int level = levelAt(far);
  const bool stays = level == level_ && ++groups_ % groups_between_cleanings != 0;
  level_ = level;
  if (stays)
    return true;
  if (level_ < 0) {
    tile_.removeEnded(group.first);
    return true;
  }
  active_.count = 0;
  for (const RayBundle& bundle : tile_.bundles(level_))
    if (bundle.longest >= group.first)
      active_.add(bundle);
  return true;
}

float
TileSweep::enterDistance(int slab) const
{
  return slab == 0 ? 0.0f : to_first_side_ + float(slab - 1);
}

kernels::SlabView
TileSweep::viewOf(int number)
{
  kernels::SlabView slab;
  slab.slab = number;
  slab.row_start = inVoxel(start_[axes_.row]);
  slab.column_start = inVoxel(start_[axes_.column]);
  slab.enter = enterDistance(number);
  slab.leave = to_first_side_ + float(number);
  slab.margin = marginAt(slab.leave);
  const int voxel = start_voxel_[axes_.along] + axes_.step * number;
  buffer_.show(voxel & (kBlockEdge - 1), slab);
  return slab;
}

void
TileSweep::crossAllRays(const Group& group)
{
  std::array<kernels::SlabView, kBlockEdge> slabs;
  std::size_t count = 0;
  for (int slab = group.first; slab <= group.last; ++slab)
    slabs[count++] = viewOf(slab);
  undecided_.resize(std::max(undecided_.size(), tile_.size() * kBlockEdge));
  const std::size_t left = loops_.crossSlabs(slabs.data(), count, tile_.view(),
                                             tile_.size(), undecided_.data());
  for (std::size_t i = 0; i < left; ++i)
    crossExactly(tile_.point(undecided_[i].ray), int(undecided_[i].slab));
}

void
TileSweep::crossBundles(const kernels::SlabView& slab, const Active& bundles, int level)
{
  bundles_left_.resize(std::max(bundles_left_.size(), bundles.count));
  const std::size_t left =
      loops_.crossBundles(slab, bundles.view(), bundles.count, bundles_left_.data());
  ranges_.clear();
  corners_.clear();
  Active& parts = parts_[std::size_t(level)];
  parts.count = 0;
  for (std::size_t i = 0; i < left; ++i) {
    const kernels::BundleLeft& each = bundles_left_[i];
    const RayBundle& bundle = *bundles.bundle[each.bundle];
    if (bundle.longest < slab.slab)
      continue;
    if (level > 0)
      for (std::uint32_t part = bundle.begin; part < bundle.end; ++part)
        parts.add(tile_.bundles(level - 1)[part]);
    else if (each.at_corner && slab.slab > 0)
      corners_.push_back({{bundle.begin, bundle.end}, each.row, each.column});
    else
      ranges_.push_back({bundle.begin, bundle.end});
  }
  if (level == 0)
    crossRays(slab);
  else if (parts.count > 0)
    crossBundles(slab, parts, level - 1);
}

void
TileSweep::crossRays(const kernels::SlabView& slab)
{
  left_.resize(std::max(left_.size(), tile_.size()));
  const kernels::RayView rays = tile_.view();
  std::size_t left =
      loops_.crossRays(slab, rays, ranges_.data(), ranges_.size(), left_.data());
  left += loops_.crossCorners(slab, rays, corners_.data(), corners_.size(),
                              left_.data() + left);
  for (std::size_t i = 0; i < left; ++i)
    crossExactly(tile_.point(left_[i]), slab.slab);
}

void
TileSweep::crossExactly(std::uint32_t point, int slab)
{
  const QuantizedPoint end = start_ + ends_[point].cast<std::int64_t>();
  traverseSegmentFrom(start_, end, axes_.along, slab, [&](const VoxelIndex& voxel) {
    return std::abs(voxel[axes_.along] - start_voxel_[axes_.along]) <= slab &&
           crossed_.add(voxel);
  });
}

void
TileSweep::Active::add(const RayBundle& added)
{
  if (reach.size() < count + 1 + kernels::slab_lanes) {
    const std::size_t room = 2 * count + 4 * kernels::slab_lanes;
    for (std::vector<float>& values : slopes)
      values.resize(room);
    reach.resize(room);
    bundle.resize(room);
  }
  slopes[0][count] = added.row_low;
  slopes[1][count] = added.row_high;
  slopes[2][count] = added.column_low;
  slopes[3][count] = added.column_high;
  for (std::size_t corner = 0; corner < 4; ++corner) {
    slopes[4 + corner][count] = added.corner_row[corner];
    slopes[8 + corner][count] = added.corner_column[corner];
  }
  reach[count] = added.reach;
  bundle[count] = &added;
  ++count;
}

kernels::BundleView
TileSweep::Active::view() const
{
  kernels::BundleView view{
      slopes[0].data(), slopes[1].data(), slopes[2].data(), slopes[3].data(), {}, {},
      reach.data()};
  for (std::size_t corner = 0; corner < 4; ++corner) {
    view.corner_row[corner] = slopes[4 + corner].data();
    view.corner_column[corner] = slopes[8 + corner].data();
  }
  return view;
}

} // namespace pcl_semantic
