/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// What SemanticVoxelMap gives out: clouds of occupied voxels and the state of a place.

#include <pcl_semantic/map/semantic_voxel_map.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pcl_semantic {

namespace {

// Measured and refined distribution of a record; all zero where it has no label.
void
readDistributions(const VoxelBlock& block, int record, int classes, float* measured,
                  float* refined)
{
  std::fill_n(measured, classes, 0.0f);
  if (block.records[record].label_observations > 0)
    distributionFromLog(block.measured.data() + record * classes, classes, measured);
  const float* const stored = block.refined.data() + record * classes;
  const bool is_refined =
      std::any_of(stored, stored + classes, [](float p) { return p > 0.0f; });
  std::copy_n(is_refined ? stored : measured, classes, refined);
}

void
setColour(const VoxelRecord& record, pcl::PointXYZRGBL& point)
{
  const auto mean = [&](int channel) {
    const std::uint32_t count = std::max(record.colour_count, 1u);
    return static_cast<std::uint8_t>((record.colour_sum[channel] + count / 2) / count);
  };
  point.r = mean(0);
  point.g = mean(1);
  point.b = mean(2);
}

VoxelCloud
emptyVoxels(std::size_t count, int classes)
{
  VoxelCloud voxels;
  voxels.measured = LabelDistributions(classes, Eigen::Index(count));
  voxels.refined = LabelDistributions(classes, Eigen::Index(count));
  voxels.indices.resize(count);
  voxels.observations.resize(count);
  voxels.cloud->resize(count);
  voxels.cloud->is_dense = true;
  return voxels;
}

// Voxel i of a cloud, from its place in a block.
void
setVoxel(const VoxelBlock& block, int place, const VoxelIndex& index, std::size_t i,
         VoxelCloud& voxels)
{
  const int record = block.record[place];
  const auto column = Eigen::Index(i);
  readDistributions(block, record, voxels.measured.classes(),
                    voxels.measured.column(column), voxels.refined.column(column));
  voxels.indices[i] = index;
  voxels.observations[i] = block.records[record].observations;
  const Eigen::Vector3d centre =
      (index.cast<double>().array() + 0.5).matrix() * voxels.voxel_size;
  pcl::PointXYZRGBL& point = (*voxels.cloud)[i];
  point.getVector3fMap() = (centre - voxels.origin).cast<float>();
  setColour(block.records[record], point);
  point.label = voxels.refined.mapLabel(column);
}

} // namespace

VoxelCloud
SemanticVoxelMap::occupied() const
{
  std::vector<std::pair<VoxelIndex, const VoxelBlock*>> blocks;
  grid_.forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    blocks.emplace_back(index, &block);
  });
  return makeCloud(std::move(blocks));
}

VoxelCloud
SemanticVoxelMap::occupiedEverywhere() const
{
  std::vector<std::pair<VoxelIndex, const VoxelBlock*>> blocks;
  const auto add = [&](const VoxelIndex& index, const VoxelBlock& block) {
    blocks.emplace_back(index, &block);
  };
  grid_.forEach(add);
  store_->forEach(add);
  std::sort(blocks.begin(), blocks.end(), [](const auto& a, const auto& b) {
    return VoxelIndexLess()(a.first, b.first);
  });
  return makeCloud(std::move(blocks));
}

VoxelCloud
SemanticVoxelMap::makeCloud(
    std::vector<std::pair<VoxelIndex, const VoxelBlock*>> blocks) const
{
  const auto is_occupied = [&](const VoxelBlock& block, int place) {
    return block.record[place] != VoxelBlock::kNoRecord &&
           occupancy_update_.isOccupied(block.log_odds[place]);
  };
  std::vector<std::size_t> first(blocks.size() + 1, 0);
#pragma omp parallel for schedule(dynamic, 64)
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (int place = 0; place < kBlockVoxels; ++place)
      first[b + 1] += is_occupied(*blocks[b].second, place);
  std::partial_sum(first.begin(), first.end(), first.begin());

  VoxelCloud voxels = emptyVoxels(first.back(), label_set_.size());
  voxels.voxel_size = parameters_.voxel_size;
  voxels.origin = origin_;
#pragma omp parallel for schedule(dynamic, 64)
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const VoxelBlock& block = *blocks[b].second;
    std::size_t i = first[b];
    for (int place = 0; place < kBlockVoxels; ++place)
      if (is_occupied(block, place))
        setVoxel(block, place, voxelAt(blocks[b].first, place), i++, voxels);
  }
  return voxels;
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
  if (!block || block->log_odds[place] == kUnknown)
    return Occupancy::unknown;
  return occupancy_update_.isOccupied(block->log_odds[place]) ? Occupancy::occupied
                                                              : Occupancy::free;
}

Label
SemanticVoxelMap::label(const Eigen::Vector3d& point) const
{
  int place = 0;
  const VoxelBlock* const block = findVoxel(point, place);
  if (!block || block->record[place] == VoxelBlock::kNoRecord ||
      !occupancy_update_.isOccupied(block->log_odds[place]))
    return kUnlabelled;
  const int classes = label_set_.size();
  const int record = block->record[place];
  const Label refined = mapLabel(block->refined.data() + record * classes, classes);
  if (refined != kUnlabelled || block->records[record].label_observations == 0)
    return refined;
  // The largest log-probability is 0, the others are negative.
  const float* const measured = block->measured.data() + record * classes;
  return static_cast<Label>(std::max_element(measured, measured + classes) - measured +
                            1);
}

} // namespace pcl_semantic
