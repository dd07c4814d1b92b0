// SPDX-License-Identifier: BSD-3-Clause
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

// The parts of some bundles.
template <typename Rows>
void
takeApart(const BundleRows& bundles, const std::vector<std::uint32_t>& wanted,
          std::size_t count, const Rows& all, Rows& parts)
{
  parts.count = 0;
  parts.reserve(all.count + 4);
  for (std::size_t i = 0; i < count; ++i)
    parts.add(all, std::size_t(bundles.numbers[kBegin][wanted[i]]),
              std::size_t(bundles.numbers[kEnd][wanted[i]]));
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
  const int longest = tile_.all().numbers[kLongest][0];
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
  const auto& slopes = tile_.all().slopes;
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
      cellsBetween(slopes[0][0], slopes[1][0], inVoxel(start_[axes_.row]), near, far),
      axes_.row);
  const auto columns = clipped(cellsBetween(slopes[2][0], slopes[3][0],
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
  const BundleRows& all_bundles = tile_.bundles(level_);
  active_.count = 0;
  active_.reserve(all_bundles.count);
  active_.add(all_bundles, 0, all_bundles.count);
  active_.removeEnded(group.first);
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
  const RayRows& rays = tile_.rays();
  undecided_.resize(std::max(undecided_.size(), rays.count * kBlockEdge));
  const std::size_t left = loops_.crossSlabs(slabs.data(), count, columnsOf(rays),
                                             rays.count, undecided_.data());
  for (std::size_t i = 0; i < left; ++i)
    crossExactly(std::uint32_t(rays.numbers[kPoint][undecided_[i].ray]),
                 int(undecided_[i].slab));
}

void
TileSweep::crossBundles(const kernels::SlabView& slab, const BundleRows& bundles,
                        int level)
{
  left_.resize(std::max(left_.size(), bundles.count));
  const std::size_t left =
      loops_.crossBundles(slab, columnsOf(bundles), bundles.count, left_.data());
  if (level == 0)
    return crossRays(slab, bundles, left);
  BundleRows& parts = parts_[std::size_t(level)];
  takeApart(bundles, left_, left, tile_.bundles(level - 1), parts);
  if (parts.count > 0)
    crossBundles(slab, parts, level - 1);
}

void
TileSweep::crossRays(const kernels::SlabView& slab, const BundleRows& bundles,
                     std::size_t count)
{
  takeApart(bundles, left_, count, tile_.rays(), rays_);
  left_.resize(std::max(left_.size(), rays_.count));
  const std::size_t left =
      loops_.crossRays(slab, columnsOf(rays_), rays_.count, left_.data());
  for (std::size_t i = 0; i < left; ++i)
    crossExactly(std::uint32_t(rays_.numbers[kPoint][left_[i]]), slab.slab);
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

} // namespace pcl_semantic
