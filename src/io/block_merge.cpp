// SPDX-License-Identifier: BSD-3-Clause
#include "block_merge.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

// Fixed point of log-probabilities, so that sums do not depend on the order.
constexpr double kLogScale = double(std::int64_t(1) << 40);

constexpr std::uint32_t kLargestColourCount = 1u << 22; // as when pixels are fused

// What one map knows of a voxel that it has hit.
struct Source {
  const VoxelBlock* block;
  std::size_t record;
};

std::uint32_t
saturate(std::uint64_t value)
{
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>(value, std::numeric_limits<std::uint32_t>::max()));
}

StoredLogOdds
mergeLogOdds(const std::vector<const VoxelBlock*>& blocks, std::size_t place,
             const FusionParameters& fusion)
{
  int sum = 0;
  bool is_known = false;
  for (const VoxelBlock* const block : blocks)
    if (block->log_odds[place] != kUnknown) {
      sum += block->log_odds[place];
      is_known = true;
    }
  if (!is_known)
    return kUnknown;
  const int lowest = storedLogOdds(fusion.min_probability);
  const int highest = storedLogOdds(fusion.max_probability);
  return static_cast<StoredLogOdds>(std::clamp(sum, lowest, highest));
}

VoxelRecord
mergeRecords(const std::vector<Source>& sources)
{
  std::uint64_t colour[3] = {}, colours = 0, observations = 0, labels = 0;
  for (const Source& source : sources) {
    const VoxelRecord& record = source.block->records[source.record];
    for (int channel = 0; channel < 3; ++channel)
      colour[channel] += record.colour_sum[std::size_t(channel)];
    colours += record.colour_count;
    observations += record.observations;
    labels += record.label_observations;
  }
  for (; colours > kLargestColourCount; colours /= 2)
    for (std::uint64_t& sum : colour)
      sum /= 2;
  return {{saturate(colour[0]), saturate(colour[1]), saturate(colour[2])},
          saturate(colours),
          saturate(observations),
          saturate(labels)};
}

// Eq. (1) of the paper over all maps: the sum of the logs, shifted so that the largest
// is 0, and clamped.
void
mergeMeasured(const std::vector<Source>& sources, int classes, double log_ratio,
              float* merged)
{
  std::vector<std::int64_t> sums(std::size_t(classes), 0);
  for (const Source& source : sources) {
    const float* const measured =
        source.block->measured.data() + source.record * std::size_t(classes);
    for (std::size_t k = 0; k < sums.size(); ++k)
      sums[k] +=
          std::llround(std::clamp(double(measured[k]), -log_ratio, 0.0) * kLogScale);
  }
  const std::int64_t largest = *std::max_element(sums.begin(), sums.end());
  for (std::size_t k = 0; k < sums.size(); ++k)
    merged[k] = float(std::max(double(sums[k] - largest) / kLogScale, -log_ratio));
}

void
mergeVoxel(const std::vector<Source>& sources, int place, int classes,
           const FusionParameters& fusion, VoxelBlock& merged)
{
  const auto count = static_cast<std::size_t>(classes);
  const auto record = static_cast<std::size_t>(merged.makeRecord(place, classes));
  merged.records[record] = mergeRecords(sources);
  float* const measured = merged.measured.data() + record * count;
  std::vector<Source> labelled = sources;
  labelled.erase(
      std::remove_if(labelled.begin(), labelled.end(),
                     [](const Source& source) {
                       return source.block->records[source.record].label_observations ==
                              0;
                     }),
      labelled.end());
  if (labelled.size() == 1) // without rounding
    std::copy_n(labelled[0].block->measured.data() + labelled[0].record * count, count,
                measured);
  else if (labelled.size() > 1)
    mergeMeasured(labelled, classes, std::log(fusion.label_max_ratio), measured);
  if (sources.size() == 1)
    std::copy_n(sources[0].block->refined.data() + sources[0].record * count, count,
                merged.refined.data() + record * count);
}

} // namespace

VoxelBlock
mergeBlocks(const std::vector<const VoxelBlock*>& blocks, int classes,
            const FusionParameters& fusion)
{
  VoxelBlock merged;
  std::vector<Source> sources;
  for (int place = 0; place < kBlockVoxels; ++place) {
    merged.log_odds[std::size_t(place)] =
        mergeLogOdds(blocks, std::size_t(place), fusion);
    sources.clear();
    for (const VoxelBlock* const block : blocks)
      if (block->recordAt(place) != VoxelBlock::kNoRecord)
        sources.push_back({block, std::size_t(block->recordAt(place))});
    if (!sources.empty())
      mergeVoxel(sources, place, classes, fusion, merged);
  }
  return merged;
}

} // namespace pcl_semantic
