// SPDX-License-Identifier: BSD-3-Clause
#include "block_reader.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace pcl_semantic {

namespace {

// Reads measured and refined distribution of a record; all zero without a label.
// Returns whether a refined one is stored.
bool
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
  return is_refined;
}

std::array<std::uint8_t, 3>
meanColour(const VoxelRecord& record)
{
  std::array<std::uint8_t, 3> colour;
  const std::uint32_t count = std::max(record.colour_count, 1u);
  for (std::size_t channel = 0; channel < 3; ++channel)
    colour[channel] =
        static_cast<std::uint8_t>((record.colour_sum[channel] + count / 2) / count);
  return colour;
}

// Mean hit position of a voxel, world frame [voxels].
Eigen::Vector3d
positionOf(const VoxelIndex& voxel, const VoxelRecord& record)
{
  constexpr double unit = 1.0 / 65536.0;
  const auto& [x, y, z] = record.position;
  return voxel.cast<double>() + unit * Eigen::Vector3d(x, y, z);
}

// Relative to the cloud's origin [m]. Far from the origin, single precision may move it
// out of its voxel; then the centre.
Eigen::Vector3f
pointOf(const VoxelIndex& voxel, const VoxelRecord& record, const VoxelCloud& voxels)
{
  const auto relative = [&](const Eigen::Vector3d& position) -> Eigen::Vector3f {
    return (voxels.voxel_size * position - voxels.origin).cast<float>();
  };
  const Eigen::Vector3f point = relative(positionOf(voxel, record));
  const Eigen::Array3d cell =
      (point.cast<double>() + voxels.origin).array() / voxels.voxel_size;
  if ((cell.floor() == voxel.cast<double>().array()).all())
    return point;
  return relative(voxel.cast<double>() + Eigen::Vector3d::Constant(0.5));
}

} // namespace

Label
measuredLabel(const VoxelBlock& block, int offset, int classes)
{
  const int record = block.recordAt(offset);
  if (block.records[record].label_observations == 0)
    return kUnlabelled;
  // The largest log-probability is 0, the others are negative.
  const float* const measured = block.measured.data() + record * classes;
  return static_cast<Label>(std::max_element(measured, measured + classes) - measured +
                            1);
}

Label
BlockReader::label(const VoxelBlock& block, int offset) const
{
  const int record = block.recordAt(offset);
  const Label refined = mapLabel(block.refined.data() + record * classes_, classes_);
  return refined != kUnlabelled ? refined : measuredLabel(block, offset, classes_);
}

VoxelState
BlockReader::state(const VoxelIndex& block_index, const VoxelBlock& block,
                   int offset) const
{
  VoxelState state;
  state.index = voxelAt(block_index, offset);
  state.occupancy = occupancy(block, offset);
  if (state.occupancy != Occupancy::unknown)
    state.log_odds = float(block.log_odds[offset]) * kLogOddsUnit;
  LabelDistributions refined(classes_, 1);
  state.measured.resize(std::size_t(classes_));
  const int record = block.recordAt(offset);
  const bool is_hit = record != VoxelBlock::kNoRecord;
  state.position = voxel_size_ * positionOf(state.index, is_hit ? block.records[record]
                                                                : VoxelRecord());
  if (is_hit) {
    state.colour = meanColour(block.records[record]);
    state.observations = block.records[record].observations;
    readDistributions(block, record, classes_, state.measured.data(),
                      refined.column(0));
  }
  state.refined.assign(refined.column(0), refined.column(0) + classes_);
  state.label = refined.mapLabel(0);
  state.entropy = refined.entropy(0);
  return state;
}

std::size_t
BlockReader::countOccupied(const VoxelBlock& block) const
{
  if (block.records.empty())
    return 0;
  std::size_t count = 0; // isOccupied() would prevent vectorisation
  for (std::size_t offset = 0; offset < kBlockVoxels; ++offset)
    count += int(block.record_of[offset] != VoxelBlock::kNoRecord) &
             int(occupancy_.isOccupied(block.log_odds[offset]));
  return count;
}

VoxelCloud
BlockReader::makeCloud(std::size_t count, double voxel_size,
                       const Eigen::Vector3d& origin) const
{
  VoxelCloud voxels;
  // Uninitialised: read() writes all values, in parallel.
  voxels.measured.matrix().resize(classes_, Eigen::Index(count));
  voxels.refined.matrix().resize(classes_, Eigen::Index(count));
  voxels.is_refined.resize(count);
  voxels.indices.resize(count);
  voxels.observations.resize(count);
  voxels.cloud->resize(count);
  voxels.cloud->is_dense = true;
  voxels.voxel_size = voxel_size;
  voxels.origin = origin;
  return voxels;
}

void
BlockReader::read(const VoxelIndex& index, const VoxelBlock& block, std::size_t first,
                  VoxelCloud& voxels) const
{
  if (block.records.empty())
    return;
  std::size_t i = first;
  for (int offset = 0; offset < kBlockVoxels; ++offset) {
    if (!isOccupied(block, offset))
      continue;
    const int record = block.recordAt(offset);
    const auto column = Eigen::Index(i);
    voxels.is_refined[i] =
        readDistributions(block, record, classes_, voxels.measured.column(column),
                          voxels.refined.column(column));
    voxels.indices[i] = voxelAt(index, offset);
    voxels.observations[i] = block.records[record].observations;
    pcl::PointXYZRGBL& point = (*voxels.cloud)[i];
    point.getVector3fMap() = pointOf(voxels.indices[i], block.records[record], voxels);
    const std::array<std::uint8_t, 3> colour = meanColour(block.records[record]);
    point.r = colour[0];
    point.g = colour[1];
    point.b = colour[2];
    point.label = voxels.refined.mapLabel(column);
    ++i;
  }
}

VoxelCloud
BlockReader::readAll(
    const std::vector<std::pair<VoxelIndex, const VoxelBlock*>>& blocks,
    const Eigen::Vector3d& origin) const
{
  std::vector<std::size_t> first(blocks.size() + 1, 0);
#pragma omp parallel for schedule(dynamic, 64)
  for (std::size_t b = 0; b < blocks.size(); ++b)
    first[b + 1] = countOccupied(*blocks[b].second);
  std::partial_sum(first.begin(), first.end(), first.begin());
  VoxelCloud voxels = makeCloud(first.back(), voxel_size_, origin);
#pragma omp parallel for schedule(dynamic, 64)
  for (std::size_t b = 0; b < blocks.size(); ++b)
    read(blocks[b].first, *blocks[b].second, first[b], voxels);
  return voxels;
}

} // namespace pcl_semantic
