// SPDX-License-Identifier: BSD-3-Clause
#include "block_merge.h"

#include "map/block_reader.h"
#include "map/voxel_fusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

namespace pcl_semantic {

namespace {

// Scale of log-probabilities as integers. Sums of integers do not depend on the order
// of the maps.
constexpr double kLogScale = double(std::int64_t(1) << 40);

constexpr std::uint32_t kMaxColourCount = 1u << 22; // as in VoxelMeasurement

// A voxel that was hit, in one of the maps.
struct Source {
  const VoxelRecord* record;
  const float *measured, *refined; // L values
};

std::uint32_t
saturate(std::uint64_t value)
{
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>(value, std::numeric_limits<std::uint32_t>::max()));
}

StoredLogOdds
mergeLogOdds(const std::vector<const VoxelBlock*>& blocks, std::size_t offset,
             const FusionParameters& fusion)
{
  int sum = 0;
  bool is_known = false;
  for (const VoxelBlock* const block : blocks)
    if (block->log_odds[offset] != kUnknown) {
      sum += block->log_odds[offset];
      is_known = true;
    }
  if (!is_known)
    return kUnknown;
  const int lowest = storedLogOdds(fusion.min_probability);
  const int highest = storedLogOdds(fusion.max_probability);
  return static_cast<StoredLogOdds>(std::clamp(sum, lowest, highest));
}

// Of the labels; 0 without labels.
std::uint16_t
bestDeviation(const std::vector<Source>& sources)
{
  std::optional<std::uint16_t> best;
  for (const Source& source : sources)
    if (source.record->label_observations > 0)
      best = std::min(best.value_or(source.record->label_deviation),
                      source.record->label_deviation);
  return best.value_or(0);
}

VoxelRecord
mergeRecords(const std::vector<Source>& sources, bool weigh_labels)
{
  std::uint64_t colour[3] = {}, position[3] = {};
  std::uint64_t weight = 0, colours = 0, observations = 0, labels = 0;
  for (const Source& source : sources) {
    const VoxelRecord& record = *source.record;
    for (int channel = 0; channel < 3; ++channel)
      colour[channel] += record.colour_sum[std::size_t(channel)];
    for (int axis = 0; axis < 3; ++axis)
      position[axis] += std::uint64_t(record.position[std::size_t(axis)]) *
                        std::max(record.observations, 1u);
    weight += std::max(record.observations, 1u);
    colours += record.colour_count;
    observations += record.observations;
    labels += record.label_observations;
  }
  const auto deviation = bestDeviation(sources);
  for (; colours > kMaxColourCount; colours /= 2)
    for (std::uint64_t& sum : colour)
      sum /= 2;
  VoxelRecord merged{{saturate(colour[0]), saturate(colour[1]), saturate(colour[2])},
                     saturate(colours),
                     saturate(observations),
                     saturate(labels)};
  for (std::size_t axis = 0; axis < 3; ++axis)
    merged.position[axis] = std::uint16_t(position[axis] / weight);
  merged.label_deviation = weigh_labels ? deviation : std::uint16_t(0);
  return merged;
}

// Eq. (1) of the paper over all maps: adds the log-probabilities, weighted as
// VoxelMeasurement::fuseLabels() does. The sums are stored relative to the largest sum
// and clamped at -log_ratio.
void
mergeMeasured(const std::vector<Source>& sources, int classes,
              const FusionParameters& fusion, float* merged)
{
  const double log_ratio = std::log(fusion.label_max_ratio);
  std::array<std::int64_t, 256> sums{};
  const std::uint16_t best = bestDeviation(sources);
  for (const Source& source : sources) {
    const double weight =
        fusion.weigh_labels ? labelWeight(best, source.record->label_deviation) : 1.0;
    for (std::size_t k = 0; k < std::size_t(classes); ++k) {
      const double log = std::clamp(double(source.measured[k]), -log_ratio, 0.0);
      sums[k] += std::llround(weight * log * kLogScale);
    }
  }
  const std::int64_t largest = *std::max_element(sums.begin(), sums.begin() + classes);
  for (std::size_t k = 0; k < std::size_t(classes); ++k)
    merged[k] = float(std::max(double(sums[k] - largest) / kLogScale, -log_ratio));
}

void
mergeVoxel(const std::vector<Source>& sources, int offset, int classes,
           const FusionParameters& fusion, bool keeps_refined, VoxelBlock& merged)
{
  const auto count = static_cast<std::size_t>(classes);
  const auto record = static_cast<std::size_t>(merged.makeRecord(offset, classes));
  merged.records[record] = mergeRecords(sources, fusion.weigh_labels);
  float* const measured = merged.measured.data() + record * count;
  std::vector<Source> labelled;
  for (const Source& source : sources)
    if (source.record->label_observations > 0)
      labelled.push_back(source);
  if (labelled.size() == 1) // an exact copy: the sum would be rounded
    std::copy_n(labelled[0].measured, count, measured);
  else if (labelled.size() > 1)
    mergeMeasured(labelled, classes, fusion, measured);
  if (keeps_refined)
    std::copy_n(sources[0].refined, count, merged.refined.data() + record * count);
}

// A moving object is hit in one map and seen past in another: free wins there.
void
freeDynamic(const std::vector<const VoxelBlock*>& blocks, std::size_t offset,
            const FusionParameters& fusion, StoredLogOdds& merged)
{
  const int two_misses = 2 * storedLogOdds(fusion.miss_probability);
  for (const VoxelBlock* const block : blocks) {
    const StoredLogOdds log_odds = block->log_odds[offset];
    const int record = block->recordAt(int(offset));
    const bool has_hits = record != VoxelBlock::kNoRecord &&
                          block->records[std::size_t(record)].observations > 0;
    if (log_odds != kUnknown && !has_hits && log_odds <= two_misses)
      merged = std::min(merged, log_odds);
  }
}

} // namespace

VoxelBlock
mergeBlocks(const std::vector<const VoxelBlock*>& blocks, const LabelSet& label_set,
            const FusionParameters& fusion)
{
  const int classes = label_set.size();
  VoxelBlock merged;
  const auto have_hits =
      std::count_if(blocks.begin(), blocks.end(),
                    [](const auto* block) { return !block->records.empty(); });
  // A CRF over the merged map would give other results where maps overlap.
  const bool keeps_refined = have_hits == 1;
  std::vector<Source> sources;
  for (int offset = 0; offset < kBlockVoxels; ++offset) {
    merged.log_odds[std::size_t(offset)] =
        mergeLogOdds(blocks, std::size_t(offset), fusion);
    sources.clear();
    for (const VoxelBlock* const block : blocks)
      if (const int record = block->recordAt(offset); record != VoxelBlock::kNoRecord)
        sources.push_back({&block->records[std::size_t(record)],
                           block->measured.data() + record * classes,
                           block->refined.data() + record * classes});
    if (sources.empty())
      continue;
    mergeVoxel(sources, offset, classes, fusion, keeps_refined, merged);
    if (fusion.free_dynamic &&
        label_set[measuredLabel(merged, offset, classes)].dynamic)
      freeDynamic(blocks, std::size_t(offset), fusion,
                  merged.log_odds[std::size_t(offset)]);
  }
  return merged;
}

} // namespace pcl_semantic
