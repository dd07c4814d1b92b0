/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// What SemanticVoxelMap gives out: clouds of occupied voxels and the state of a place.

#include <pcl_semantic/map/semantic_voxel_map.h>

#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace pcl_semantic {

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
  return (point / parameters_.voxel_size).array().floor().cast<int>();
}

bool
SemanticVoxelMap::isNear(const Eigen::Vector3d& point) const
{
  const double farthest = kMaxVoxelIndex * parameters_.voxel_size;
  return (point.array().abs() <= farthest).all(); // false for NaN
}

const VoxelBlock*
SemanticVoxelMap::findVoxel(const Eigen::Vector3d& point, int& place) const
{
  if (!isNear(point))
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
  return labelAt(point);
}

std::vector<Label>
SemanticVoxelMap::labels(const std::vector<Eigen::Vector3d>& points) const
{
  const auto reading = lock_.read();
  std::vector<Label> labels(points.size());
#pragma omp parallel for schedule(dynamic, 4096)
  for (std::size_t i = 0; i < points.size(); ++i)
    labels[i] = labelAt(points[i]);
  return labels;
}

Label
SemanticVoxelMap::labelAt(const Eigen::Vector3d& point) const
{
  int place = 0;
  const VoxelBlock* const block = findVoxel(point, place);
  return block && reader_.isOccupied(*block, place) ? reader_.label(*block, place)
                                                    : kUnlabelled;
}

VoxelState
SemanticVoxelMap::state(const Eigen::Vector3d& point) const
{
  const auto reading = lock_.read();
  int place = 0;
  if (const VoxelBlock* const block = findVoxel(point, place))
    return reader_.state(blockOf(voxelOf(point)), *block, place);
  VoxelState unknown = reader_.state(VoxelIndex::Zero(), VoxelBlock(), 0);
  if (isNear(point))
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
  if (!isNear(from) || !isNear(to))
    return found;
  const auto visit = [&](const VoxelIndex& voxel) {
    const VoxelBlock* const block = grid_.find(blockOf(voxel));
    const int place = voxelInBlock(voxel);
    if (block && reader_.isOccupied(*block, place))
      found = reader_.state(blockOf(voxel), *block, place);
    return !found;
  };
  traverseSegment(quantize(from, parameters_.voxel_size),
                  quantize(to, parameters_.voxel_size), visit);
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
