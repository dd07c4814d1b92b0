// SPDX-License-Identifier: BSD-3-Clause

// What SemanticVoxelMap gives out: clouds of occupied voxels and the state of a place.

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/map/semantic_voxel_map.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace pcl_semantic {

namespace {

bool
isNear(const Eigen::Vector3d& point, double voxel_size)
{
  return (point.array().abs() <= kMaxVoxelIndex * voxel_size).all(); // false for NaN
}

Label
labelOf(const BlockReader& reader, const VoxelBlock* block, int place)
{
  return block && reader.isOccupied(*block, place) ? reader.label(*block, place)
                                                   : kUnlabelled;
}

// Where a segment is still before a box, or has just come to it: the last of the walls
// that it comes through to be inside.
struct Entry {
  int axis = 0;
  int slab = 0; ///< voxels from the start along the axis
};

// In 64 bits: a window that lies nowhere is far beyond all voxels.
using WideIndex = Eigen::Matrix<std::int64_t, 3, 1>;

// \param[in] low, high the first and the last voxel of the box
// \return nothing if the segment does not come to it
std::optional<Entry>
entryOf(const QuantizedPoint& from, const QuantizedPoint& to, const WideIndex& low,
        const WideIndex& high)
{
  const WideIndex start = voxelOf(from).cast<std::int64_t>();
  const WideIndex end = voxelOf(to).cast<std::int64_t>();
  Entry entry;
  double latest = 0.0; // in lengths of the segment
  for (int axis = 0; axis < 3; ++axis) {
    if (std::max(start[axis], end[axis]) < low[axis] ||
        std::min(start[axis], end[axis]) > high[axis])
      return std::nullopt;
    const std::int64_t slab =
        std::max(low[axis] - start[axis], start[axis] - high[axis]);
    const double time = double(slab) / std::abs(double(end[axis] - start[axis]));
    if (slab > 0 && time > latest) {
      latest = time;
      entry = {axis, int(slab)};
    }
  }
  return entry;
}

} // namespace

VoxelCloud
SemanticVoxelMap::occupied() const
{
  const auto reading = lock_.read();
  std::vector<std::pair<VoxelIndex, const VoxelBlock*>> blocks;
  grid_.forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    if (!block.records.empty())
      blocks.emplace_back(index, &block);
  });
  std::vector<std::size_t> first(blocks.size() + 1, 0);
#pragma omp parallel for schedule(dynamic, 64)
  for (std::size_t b = 0; b < blocks.size(); ++b)
    first[b + 1] = reader_.countOccupied(*blocks[b].second);
  std::partial_sum(first.begin(), first.end(), first.begin());
  VoxelCloud voxels =
      reader_.makeCloud(first.back(), parameters_.voxel_size, cloud_origin_);
#pragma omp parallel for schedule(dynamic, 64)
  for (std::size_t b = 0; b < blocks.size(); ++b)
    reader_.read(blocks[b].first, *blocks[b].second, first[b], voxels);
  return voxels;
}

VoxelCloud
SemanticVoxelMap::occupiedEverywhere() const
{
  const auto reading = lock_.read();
  std::size_t count = 0;
  visitBlocks([&](const VoxelIndex&, const VoxelBlock& block) {
    count += reader_.countOccupied(block);
  });
  VoxelCloud voxels = reader_.makeCloud(count, parameters_.voxel_size, cloud_origin_);
  std::size_t first = 0;
  visitBlocks([&](const VoxelIndex& index, const VoxelBlock& block) {
    reader_.read(index, block, first, voxels);
    first += reader_.countOccupied(block);
  });
  return voxels;
}

void
SemanticVoxelMap::forEachBlock(const VisitBlock& visit) const
{
  const auto reading = lock_.read();
  visitBlocks(visit);
}

void
SemanticVoxelMap::visitBlocks(const VisitBlock& visit) const
{
  const std::lock_guard<std::mutex> alone(store_reading_);
  // Two ordered lists become one; of a block in both, the window has the newer state.
  std::vector<std::pair<VoxelIndex, const VoxelBlock*>> window;
  grid_.forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    window.emplace_back(index, &block);
  });
  auto next = window.begin();
  const auto visitWindowBefore = [&](const VoxelIndex& index) {
    for (; next != window.end() && VoxelIndexLess()(next->first, index); ++next)
      visit(next->first, *next->second);
  };
  store_->forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    visitWindowBefore(index);
    if (!grid_.contains(index))
      visit(index, block);
  });
  for (; next != window.end(); ++next)
    visit(next->first, *next->second);
}

VoxelIndex
SemanticVoxelMap::voxelOf(const Eigen::Vector3d& point) const
{
  if (!isNear(point, parameters_.voxel_size))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "a point at " << point.transpose() << " m lies in no voxel");
  return pcl_semantic::voxelOf(quantize(point, parameters_.voxel_size));
}

const VoxelBlock*
SemanticVoxelMap::findVoxel(const Eigen::Vector3d& point, int& place) const
{
  if (!isNear(point, parameters_.voxel_size))
    return nullptr;
  const VoxelIndex voxel = voxelOf(point);
  place = voxelInBlock(voxel);
  return grid_.find(blockOf(voxel));
}

Occupancy
SemanticVoxelMap::occupancy(const Eigen::Vector3d& point) const
{
  const auto reading = lock_.read();
  int place = 0;
  const VoxelBlock* const block = findVoxel(point, place);
  return block ? reader_.occupancy(*block, place) : Occupancy::unknown;
}

Label
SemanticVoxelMap::label(const Eigen::Vector3d& point) const
{
  const auto reading = lock_.read();
  int place = 0;
  const VoxelBlock* const block = findVoxel(point, place);
  return labelOf(reader_, block, place);
}

std::vector<Label>
SemanticVoxelMap::labels(const std::vector<Eigen::Vector3d>& points) const
{
  const auto reading = lock_.read();
  std::vector<Label> labels(points.size());
#pragma omp parallel for schedule(dynamic, 4096)
  for (std::size_t i = 0; i < points.size(); ++i) {
    int place = 0;
    const VoxelBlock* const block = findVoxel(points[i], place);
    labels[i] = labelOf(reader_, block, place);
  }
  return labels;
}

VoxelState
SemanticVoxelMap::state(const Eigen::Vector3d& point) const
{
  const auto reading = lock_.read();
  int place = 0;
  if (const VoxelBlock* const block = findVoxel(point, place))
    return reader_.state(blockOf(voxelOf(point)), *block, place);
  VoxelState unknown = reader_.state(VoxelIndex::Zero(), VoxelBlock(), 0);
  if (isNear(point, parameters_.voxel_size))
    unknown.index = voxelOf(point);
  return unknown;
}

std::vector<VoxelState>
SemanticVoxelMap::states(const Eigen::AlignedBox3d& box) const
{
  const auto reading = lock_.read();
  const double farthest = kMaxVoxelIndex * parameters_.voxel_size;
  std::vector<VoxelState> states;
  if (!(box.min().array() <= box.max().array()).all()) // or NaN
    return states;
  const VoxelIndex low = voxelOf(box.min().cwiseMax(-farthest).cwiseMin(farthest));
  const VoxelIndex high = voxelOf(box.max().cwiseMax(-farthest).cwiseMin(farthest));
  grid_.forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    if ((index.array() < blockOf(low).array()).any() ||
        (index.array() > blockOf(high).array()).any())
      return;
    for (int place = 0; place < kBlockVoxels; ++place) {
      const Eigen::Array3i voxel = voxelAt(index, place).array();
      if (block.log_odds[std::size_t(place)] != kUnknown &&
          (voxel >= low.array()).all() && (voxel <= high.array()).all())
        states.push_back(reader_.state(index, block, place));
    }
  });
  return states;
}

std::optional<VoxelState>
SemanticVoxelMap::firstOccupied(const Eigen::Vector3d& from,
                                const Eigen::Vector3d& to) const
{
  const auto reading = lock_.read();
  std::optional<VoxelState> found;
  const double voxel_size = parameters_.voxel_size;
  if (!isNear(from, voxel_size) || !isNear(to, voxel_size))
    return found;
  bool inside = false;
  const auto visit = [&](const VoxelIndex& voxel) {
    if (!grid_.contains(blockOf(voxel)))
      return !inside; // it does not come back
    inside = true;
    const VoxelBlock* const block = grid_.find(blockOf(voxel));
    const int place = voxelInBlock(voxel);
    if (block && reader_.isOccupied(*block, place))
      found = reader_.state(blockOf(voxel), *block, place);
    return !found;
  };
  const QuantizedPoint start = quantize(from, voxel_size),
                       end = quantize(to, voxel_size);
  const WideIndex low = grid_.origin().cast<std::int64_t>() * kBlockEdge;
  const WideIndex high =
      low + grid_.size().cast<std::int64_t>() * kBlockEdge - WideIndex::Ones();
  if (const std::optional<Entry> entry = entryOf(start, end, low, high))
    traverseSegmentFrom(start, end, entry->axis, entry->slab, visit);
  return found;
}

std::size_t
SemanticVoxelMap::memory() const
{
  const auto reading = lock_.read();
  std::size_t bytes = grid_.slots() * sizeof(std::unique_ptr<VoxelBlock>);
  grid_.forEach(
      [&](const VoxelIndex&, const VoxelBlock& block) { bytes += memoryOf(block); });
  return bytes + ray_caster_.memory();
}

Eigen::Vector3d
SemanticVoxelMap::cloudOrigin() const
{
  const auto reading = lock_.read();
  return cloud_origin_;
}

} // namespace pcl_semantic
