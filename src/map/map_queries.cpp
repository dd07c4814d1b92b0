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
  std::size_t count = 0;
  forEachBlock([&](const VoxelIndex&, const VoxelBlock& block) {
    count += reader_.countOccupied(block);
  });
  VoxelCloud voxels = reader_.makeCloud(count, parameters_.voxel_size, cloud_origin_);
  std::size_t first = 0;
  forEachBlock([&](const VoxelIndex& index, const VoxelBlock& block) {
    reader_.read(index, block, first, voxels);
    first += reader_.countOccupied(block);
  });
  return voxels;
}

void
SemanticVoxelMap::forEachBlock(
    const std::function<void(const VoxelIndex&, const VoxelBlock&)>& visit) const
{
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

const VoxelBlock*
SemanticVoxelMap::findVoxel(const Eigen::Vector3d& point, int& place) const
{
  const double farthest = kMaxVoxelIndex * parameters_.voxel_size;
  if (!((point.array().abs() <= farthest).all()))
    return nullptr;
  const VoxelIndex voxel = voxelOf(point);
  place = voxelInBlock(voxel);
  return grid_.find(blockOf(voxel));
}

Occupancy
SemanticVoxelMap::occupancy(const Eigen::Vector3d& point) const
{
  int place = 0;
  const VoxelBlock* const block = findVoxel(point, place);
  return block ? reader_.occupancy(*block, place) : Occupancy::unknown;
}

Label
SemanticVoxelMap::label(const Eigen::Vector3d& point) const
{
  int place = 0;
  const VoxelBlock* const block = findVoxel(point, place);
  return block && reader_.isOccupied(*block, place) ? reader_.label(*block, place)
                                                    : kUnlabelled;
}

} // namespace pcl_semantic
