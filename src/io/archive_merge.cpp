// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/archive_merge.h>

#include "archive_database.h"
#include "core/fail.h"
#include "map/voxel_fusion.h"

#include <pcl_semantic/io/map_archive.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <tuple>
#include <vector>

namespace pcl_semantic {

namespace {

// Fixed point of log-probabilities, so that sums do not depend on the order.
constexpr double kLogScale = double(std::int64_t(1) << 40);

constexpr std::uint32_t kMaxColourCount = 1u << 22; // as when pixels are fused

// What one map knows of a voxel that it has hit.
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

VoxelRecord
mergeRecords(const std::vector<Source>& sources)
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
  for (; colours > kMaxColourCount; colours /= 2)
    for (std::uint64_t& sum : colour)
      sum /= 2;
  VoxelRecord merged{{saturate(colour[0]), saturate(colour[1]), saturate(colour[2])},
                     saturate(colours),
                     saturate(observations),
                     saturate(labels)};
  for (std::size_t axis = 0; axis < 3; ++axis)
    merged.position[axis] = std::uint16_t(position[axis] / weight);
  return merged;
}

// Eq. (1) of the paper over all maps: the sum of the logs, shifted so that the largest
// is 0, and clamped.
void
mergeMeasured(const std::vector<Source>& sources, int classes, double log_ratio,
              float* merged)
{
  std::array<std::int64_t, 256> sums{};
  for (const Source& source : sources) {
    for (std::size_t k = 0; k < std::size_t(classes); ++k) {
      const double log = std::clamp(double(source.measured[k]), -log_ratio, 0.0);
      sums[k] += std::llround(log * kLogScale);
    }
  }
  const std::int64_t largest = *std::max_element(sums.begin(), sums.begin() + classes);
  for (std::size_t k = 0; k < std::size_t(classes); ++k)
    merged[k] = float(std::max(double(sums[k] - largest) / kLogScale, -log_ratio));
}

void
mergeVoxel(const std::vector<Source>& sources, int offset, int classes,
           const FusionParameters& fusion, VoxelBlock& merged)
{
  const auto count = static_cast<std::size_t>(classes);
  const auto record = static_cast<std::size_t>(merged.makeRecord(offset, classes));
  merged.records[record] = mergeRecords(sources);
  float* const measured = merged.measured.data() + record * count;
  std::vector<Source> labelled;
  for (const Source& source : sources)
    if (source.record->label_observations > 0)
      labelled.push_back(source);
  if (labelled.size() == 1) // without rounding
    std::copy_n(labelled[0].measured, count, measured);
  else if (labelled.size() > 1)
    mergeMeasured(labelled, classes, std::log(fusion.label_max_ratio), measured);
  if (sources.size() == 1)
    std::copy_n(sources[0].refined, count, merged.refined.data() + record * count);
}

// What several maps know of the same block taken together, see mergeArchives(). A
// refined distribution of several is no longer what a CRF would conclude.
VoxelBlock
mergeBlocks(const std::vector<const VoxelBlock*>& blocks, int classes,
            const FusionParameters& fusion)
{
  VoxelBlock merged;
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
    if (!sources.empty())
      mergeVoxel(sources, offset, classes, fusion, merged);
  }
  return merged;
}

using Archives = std::vector<std::unique_ptr<MapArchive>>;

bool
areSame(const LabelSet& a, const LabelSet& b)
{
  if (a.size() != b.size())
    return false;
  for (int label = 1; label <= a.size(); ++label) {
    const LabelClass &p = a[Label(label)], &q = b[Label(label)];
    if (std::tie(p.name, p.colour, p.sky, p.dynamic, p.thin) !=
        std::tie(q.name, q.colour, q.sky, q.dynamic, q.thin))
      return false;
  }
  return true;
}

void
requireSame(const MapArchive& first, const MapArchive& other)
{
  const auto fail = [&](const char* what) {
    badInput(other.path(), ": has another ", what, " than ", first.path());
  };
  const MapParameters &p = first.header().parameters, &q = other.header().parameters;
  if (p.voxel_size != q.voxel_size)
    fail("voxel size");
  if (!areSame(first.header().label_set, other.header().label_set))
    fail("label set");
  // These say how far what was added can go, and what the result means.
  const auto clamps = [](const FusionParameters& fusion) {
    return std::tie(fusion.min_probability, fusion.max_probability,
                    fusion.occupied_probability, fusion.label_max_ratio);
  };
  if (clamps(p.fusion) != clamps(q.fusion))
    fail("min_probability, max_probability, occupied_probability or label_max_ratio");
}

ArchiveHeader
headerOf(const Archives& archives)
{
  std::vector<const MapArchive*> by_name;
  for (const auto& archive : archives)
    by_name.push_back(archive.get());
  std::sort(by_name.begin(), by_name.end(),
            [](const auto* a, const auto* b) { return a->path() < b->path(); });
  // What the result does not depend on is that of the first name.
  ArchiveHeader header = by_name.front()->header();
  header.configuration.clear();
  for (std::size_t i = 0; i < by_name.size(); ++i) {
    const MapParameters& parameters = by_name[i]->header().parameters;
    header.parameters.window = header.parameters.window.cwiseMax(parameters.window);
    header.parameters.max_range =
        std::max(header.parameters.max_range, parameters.max_range);
    header.configuration +=
        "merged_" + std::to_string(i + 1) + ": " + by_name[i]->path() + "\n";
  }
  return header;
}

ArchiveState
stateOf(const Archives& archives)
{
  const auto less = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  ArchiveState state;
  state.cloud_origin = archives.front()->state().cloud_origin;
  state.finished = true;
  for (const auto& archive : archives) {
    const ArchiveState each = archive->state();
    state.finished = state.finished && each.finished;
    if (less(each.cloud_origin, state.cloud_origin))
      state.cloud_origin = each.cloud_origin;
  }
  return state;
}

// Puts what the archives from the i-th on know of its blocks, of those that no archive
// before it has.
void
mergeBlocksOf(const Archives& archives, std::size_t i, MapArchive& merged,
              const std::function<void()>& step)
{
  const ArchiveHeader& header = merged.header();
  archives[i]->forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    step();
    if (merged.contains(index))
      return;
    std::vector<std::unique_ptr<VoxelBlock>> others;
    std::vector<const VoxelBlock*> blocks = {&block};
    for (std::size_t k = i + 1; k < archives.size(); ++k)
      if (auto other = archives[k]->get(index)) {
        blocks.push_back(other.get());
        others.push_back(std::move(other));
      }
    if (blocks.size() == 1)
      merged.put(index, block);
    else
      merged.put(index, mergeBlocks(blocks, header.label_set.size(),
                                    header.parameters.fusion));
  });
}

} // namespace

std::uint64_t
mergeArchives(const std::vector<std::string>& inputs, const std::string& output,
              const BlockProgress& progress)
{
  if (inputs.size() < 2)
    badParameter("expected two or more archives to merge");
  Archives archives;
  for (const std::string& input : inputs) {
    archives.push_back(std::make_unique<MapArchive>(input, ArchiveAccess::read));
    requireSame(*archives.front(), *archives.back());
  }
  std::size_t inputs_blocks = 0;
  for (const auto& archive : archives)
    inputs_blocks += archive->state().blocks;
  std::size_t done = 0;
  const auto step = [&] {
    if (progress)
      progress(++done, inputs_blocks);
  };
  std::uint64_t blocks = 0;
  makeArchiveFile(output, [&](const std::string& temporary) {
    const auto merged = MapArchive::create(temporary, headerOf(archives));
    for (std::size_t i = 0; i < archives.size(); ++i)
      mergeBlocksOf(archives, i, *merged, step);
    merged->commit(stateOf(archives));
    blocks = merged->state().blocks;
    merged->close();
  });
  return blocks;
}

} // namespace pcl_semantic
