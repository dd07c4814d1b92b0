// SPDX-License-Identifier: BSD-3-Clause
#include "tile_sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <numeric>

namespace pcl_semantic {

void
RayTile::set(const DirectedRay* const* rays, std::size_t count)
{
  sortByLeaf(rays, count);
  makeLevels();
}

inline RayTile::Outermost
RayTile::outermostOf(std::size_t ray) const
{
  const float u = rays_.slopes[kRowSlope][ray], v = rays_.slopes[kColumnSlope][ray];
  Outermost ends;
  ends.outward = {-u, u, -v, v, -u - v, u - v, v - u, u + v};
  ends.row_slope.fill(u);
  ends.column_slope.fill(v);
  ends.end_slab.fill(rays_.numbers[kEndSlab][ray]);
  ends.longest = rays_.numbers[kEndSlab][ray];
  return ends;
}

void
RayTile::sortByLeaf(const DirectedRay* const* rays, std::size_t count)
{
  rays_.reserve(count);
  rays_.count = count;
  leaf_.resize(count);
  std::array<std::uint32_t, (1 << (2 * kLeafBits)) + 1> next{};
  for (std::size_t i = 0; i < count; ++i)
    ++next[rays[i]->leaf + 1u];
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (std::size_t i = 0; i < count; ++i) {
    const DirectedRay& ray = *rays[i];
    const std::size_t to = next[ray.leaf]++;
    rays_.slopes[kRowSlope][to] = ray.row_slope;
    rays_.slopes[kColumnSlope][to] = ray.column_slope;
    rays_.numbers[kEndSlab][to] = ray.end_slab;
    rays_.numbers[kEndRow][to] = ray.end_row;
    rays_.numbers[kEndColumn][to] = ray.end_column;
    rays_.numbers[kPoint][to] = std::int32_t(ray.point);
    leaf_[to] = ray.leaf;
  }
}

inline void
RayTile::Outermost::take(const Outermost& other)
{
  for (std::size_t k = 0; k < directions; ++k) { // vectorised loop
    const bool further = other.outward[k] > outward[k];
    outward[k] = further ? other.outward[k] : outward[k];
    row_slope[k] = further ? other.row_slope[k] : row_slope[k];
    column_slope[k] = further ? other.column_slope[k] : column_slope[k];
    end_slab[k] = further ? other.end_slab[k] : end_slab[k];
  }
  longest = std::max(longest, other.longest);
}

void
RayTile::makeLevels()
{
  outermost_.resize(std::size_t(1) << (2 * kLeafBits));
  std::size_t count = rays_.count; // of parts: initially one per ray
  for (BundleRows& level : levels_) {
    const bool of_rays = &level == &levels_.front();
    const int shift = of_rays ? 0 : 2;
    level.count = 0;
    level.reserve(count);
    for (std::size_t i = 0; i < count;) {
      const std::size_t begin = i;
      const auto leaf = std::uint16_t(leaf_[i] >> shift);
      Outermost all = of_rays ? outermostOf(i) : outermost_[i];
      for (++i; i < count && leaf_[i] >> shift == leaf; ++i)
        all.take(of_rays ? outermostOf(i) : outermost_[i]);
      leaf_[level.count] = leaf;
      outermost_[level.count] = all;
      addTo(level, all, begin, i);
    }
    count = level.count;
  }
}

void
RayTile::addTo(BundleRows& level, const Outermost& rays, std::size_t begin,
               std::size_t end)
{
  const std::size_t to = level.count++;
  for (std::size_t k = 0; k < 2; ++k) {
    level.slopes[kRowLow + k][to] = rays.row_slope[k];
    level.slopes[kColumnLow + k][to] = rays.column_slope[2 + k];
  }
  for (std::size_t corner = 0; corner < 4; ++corner) {
    level.slopes[kCornerRow + corner][to] = rays.row_slope[4 + corner];
    level.slopes[kCornerColumn + corner][to] = rays.column_slope[4 + corner];
  }
  level.numbers[kLongest][to] = rays.longest;
  level.numbers[kReach][to] =
      *std::min_element(rays.end_slab.begin(), rays.end_slab.end());
  level.numbers[kBegin][to] = std::int32_t(begin);
  level.numbers[kEnd][to] = std::int32_t(end);
}

kernels::RayView
columnsOf(const RayRows& rays)
{
  return {rays.slopes[kRowSlope].data(), rays.slopes[kColumnSlope].data(),
          rays.numbers[kEndSlab].data(), rays.numbers[kEndRow].data(),
          rays.numbers[kEndColumn].data()};
}

kernels::BundleView
columnsOf(const BundleRows& bundles)
{
  kernels::BundleView view{bundles.slopes[kRowLow].data(),
                           bundles.slopes[kRowHigh].data(),
                           bundles.slopes[kColumnLow].data(),
                           bundles.slopes[kColumnHigh].data(),
                           {},
                           {},
                           bundles.numbers[kLongest].data(),
                           bundles.numbers[kReach].data()};
  for (std::size_t corner = 0; corner < 4; ++corner) {
    view.corner_row[corner] = bundles.slopes[kCornerRow + corner].data();
    view.corner_column[corner] = bundles.slopes[kCornerColumn + corner].data();
  }
  return view;
}

namespace {

std::uint64_t
eightBytes(const std::uint8_t* from)
{
  std::uint64_t bytes;
  std::memcpy(&bytes, from, sizeof bytes);
  return bytes;
}

// Bit i of the result is byte i, which is 0 or 1.
std::uint64_t
eightBits(std::uint64_t bytes)
{
  return bytes * 0x0102040810204080u >> 56;
}

constexpr std::size_t line_size = 64; // eight rows of eight layers

bool
isEmpty(const std::uint8_t* line)
{
  std::uint64_t any = 0;
  for (std::size_t k = 0; k < line_size; k += 8)
    any |= eightBytes(line + k);
  return any == 0;
}

} // namespace

FaceAxes::FaceAxes(int face)
    : along(face / 2), row(along == 1 ? 0 : 1), column(along == 2 ? 0 : 2),
      step(face % 2 ? -1 : 1)
{}

void
SlabBuffer::begin(const VoxelIndex& start, const FaceAxes& axes, const Extent& extent)
{
  axes_ = axes;
  const int first_row = (start[axes.row] + extent.first_row) & ~(kBlockEdge - 1);
  corner_[axes.row] = first_row;
  corner_[axes.column] = start[axes.column] + extent.first_column;
  first_row_ = first_row - start[axes.row];
  first_column_ = extent.first_column;
  const int rows = extent.last_row - first_row_ + 1;
  lines_ = (rows + kBlockEdge - 1) / kBlockEdge;
  columns_ = extent.last_column - extent.first_column + 1;
  const std::size_t size = std::size_t(columns_) * std::size_t(lines_) * line_size;
  if (cells_.size() < size + line_size) // one more line for cells outside
    cells_.resize(size + line_size);
}

void
SlabBuffer::show(int layer, kernels::SlabView& slab)
{
  slab.first_row = first_row_;
  slab.first_column = first_column_;
  slab.rows = lines_ * kBlockEdge;
  slab.columns = columns_;
  slab.column_stride = lines_ * int(line_size);
  slab.nowhere = columns_ * slab.column_stride;
  slab.cells = cells_.data() + layer;
}

void
SlabBuffer::flush(int block_along, CrossedVoxels& crossed)
{
  VoxelIndex block;
  block[axes_.along] = block_along;
  std::uint8_t* line = cells_.data();
  for (int c = 0; c < columns_; ++c) {
    const int column = corner_[axes_.column] + c;
    block[axes_.column] = column >> kBlockBits;
    for (int l = 0; l < lines_; ++l, line += line_size) {
      if (isEmpty(line))
        continue;
      block[axes_.row] = (corner_[axes_.row] >> kBlockBits) + l;
      flushLine(line, crossed.slotOf(block), column & (kBlockEdge - 1), crossed);
      std::memset(line, 0, line_size);
    }
  }
  std::memset(line, 0, line_size);
}

void
SlabBuffer::flushLine(const std::uint8_t* line, std::size_t slot, int column,
                      CrossedVoxels& crossed) const
{
  std::uint64_t bits = 0;
  std::array<std::uint64_t, kBlockEdge> by_layer{};
  for (int row = 0; row < kBlockEdge; ++row) {
    const std::uint64_t layers = eightBytes(line + row * kBlockEdge);
    if (axes_.along == 0) // layers are x, rows y, the column is z
      bits |= eightBits(layers) << (row * kBlockEdge);
    else if (axes_.along == 1) // layers are y, rows x, the column is z
      bits |= layers << row;
    else // layers are z, rows y, the column is x
      for (int z = 0; z < kBlockEdge; ++z)
        by_layer[z] |= (layers >> (8 * z) & 1) << (row * kBlockEdge + column);
  }
  if (axes_.along != 2)
    crossed.add(slot, column, bits);
  else
    for (int z = 0; z < kBlockEdge; ++z)
      crossed.add(slot, z, by_layer[z]);
}

namespace {

// Bundles are split where they become wider than this [voxels].
constexpr float widest = 1.0f;

// Ended rays are removed rarely, because removing costs more than skipping.
constexpr int groups_between_cleanings = 4;

// The level of the widest bundles that are narrow enough at a distance; -1: rays.
int
levelAt(float distance)
{
  int level = RayTile::kLevels - 1;
  while (level >= 0 && distance * RayTile::widthOf(level) > widest)
    --level;
  return level;
}

// A slope, a distance, their product, its sum with the start, and that minus a half are
// each rounded: in total at most five half-ulps of the distance, 2^-23 of it each.
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

// Cells between two slopes at distances from near to far, plus a margin of one.
std::pair<int, int>
cellsBetween(float low, float high, float start, float near, float far)
{
  return {int(std::floor(start + std::min(low * near, low * far))) - 1,
          int(std::floor(start + std::max(high * near, high * far))) + 1};
}

// Appends the parts of some bundles.
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
      return; // the window is convex, so rays that have left it do not return
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
  const auto rows = clipped(cellsBetween(slopes[kRowLow][0], slopes[kRowHigh][0],
                                         inVoxel(start_[axes_.row]), near, far),
                            axes_.row);
  const auto columns =
      clipped(cellsBetween(slopes[kColumnLow][0], slopes[kColumnHigh][0],
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
