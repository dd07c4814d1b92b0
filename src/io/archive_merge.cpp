// SPDX-License-Identifier: BSD-3-Clause
#include "archive_file.h"
#include "block_counter.h"
#include "block_merge.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/io/archive_merge.h>
#include <pcl_semantic/io/map_archive.h>

#include <algorithm>
#include <tuple>

namespace pcl_semantic {

namespace {

using Archives = std::vector<std::unique_ptr<MapArchive>>;

bool
areSame(const LabelSet& a, const LabelSet& b)
{
  if (a.size() != b.size())
    return false;
  for (int label = 1; label <= a.size(); ++label) {
    const LabelClass &p = a[Label(label)], &q = b[Label(label)];
    if (std::tie(p.name, p.colour, p.sky, p.dynamic) !=
        std::tie(q.name, q.colour, q.sky, q.dynamic))
      return false;
  }
  return true;
}

void
requireSame(const MapArchive& first, const MapArchive& other)
{
  const auto fail = [&](const char* what) {
    PCL_THROW_EXCEPTION(BadInputException, other.path() << ": has another " << what
                                                        << " than " << first.path());
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
  // What the result does not depend on is that of the first name.
  ArchiveHeader header = (*std::min_element(archives.begin(), archives.end(),
                                            [](const auto& a, const auto& b) {
                                              return a->path() < b->path();
                                            }))
                             ->header();
  std::vector<std::string> names;
  for (const auto& archive : archives) {
    const MapParameters& parameters = archive->header().parameters;
    header.parameters.window = header.parameters.window.cwiseMax(parameters.window);
    header.parameters.max_range =
        std::max(header.parameters.max_range, parameters.max_range);
    names.push_back(archive->path());
  }
  std::sort(names.begin(), names.end());
  header.configuration.clear();
  for (std::size_t i = 0; i < names.size(); ++i)
    header.configuration += "merged_" + std::to_string(i + 1) + ": " + names[i] + "\n";
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
              BlockCounter& counter)
{
  const ArchiveHeader& header = merged.header();
  archives[i]->forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    counter.step();
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
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "expected two or more archives to merge");
  Archives archives;
  for (const std::string& input : inputs) {
    archives.push_back(std::make_unique<MapArchive>(input, ArchiveAccess::read));
    requireSame(*archives.front(), *archives.back());
  }
  std::size_t inputs_blocks = 0;
  for (const auto& archive : archives)
    inputs_blocks += archive->state().blocks;
  BlockCounter counter(progress, inputs_blocks);
  std::uint64_t blocks = 0;
  makeArchiveFile(output, [&](const std::string& temporary) {
    const auto merged = MapArchive::create(temporary, headerOf(archives));
    for (std::size_t i = 0; i < archives.size(); ++i)
      mergeBlocksOf(archives, i, *merged, counter);
    merged->commit(stateOf(archives));
    blocks = merged->state().blocks;
    merged->close();
  });
  return blocks;
}

} // namespace pcl_semantic
