// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/archive_merge.h>

#include "archive_database.h"
#include "block_merge.h"
#include "core/fail.h"
#include "core/parallel_guard.h"
#include "moved_archive.h"

#include <pcl_semantic/io/map_archive.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

namespace pcl_semantic {

namespace {

using Archives = std::vector<std::unique_ptr<MovedArchive>>;

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
    by_name.push_back(&archive->archive());
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
  state.cloud_origin = archives.front()->archive().state().cloud_origin;
  state.finished = true;
  for (const auto& archive : archives) {
    const ArchiveState each = archive->archive().state();
    state.finished = state.finished && each.finished;
    if (less(each.cloud_origin, state.cloud_origin))
      state.cloud_origin = each.cloud_origin;
  }
  return state;
}

// A square of space, over all heights: what is in memory at a time.
constexpr int kTileEdge = 32; // [blocks]

struct Tile {
  int y = 0, x = 0; // [tiles]

  bool
  operator<(const Tile& other) const
  {
    return std::tie(y, x) < std::tie(other.y, other.x);
  }
};

int
tileAt(int block)
{
  return int(std::floor(double(block) / kTileEdge));
}

// Of each tile, by archive, the blocks of it and of its halo.
struct TileBlocks {
  bool is_reached = false; // by some archive, and not only its halo
  std::map<std::size_t, std::vector<VoxelIndex>> of;
};

std::map<Tile, TileBlocks>
tilesOf(const Archives& archives, int halo)
{
  std::map<Tile, TileBlocks> tiles;
  for (std::size_t i = 0; i < archives.size(); ++i)
    for (const VoxelIndex& block : archives[i]->indices()) {
      for (int y = tileAt(block.y() - halo); y <= tileAt(block.y() + halo); ++y)
        for (int x = tileAt(block.x() - halo); x <= tileAt(block.x() + halo); ++x)
          tiles[{y, x}].of[i].push_back(block);
      tiles[{tileAt(block.y()), tileAt(block.x())}].is_reached = true;
    }
  for (auto tile = tiles.begin(); tile != tiles.end();)
    tile = tile->second.is_reached ? std::next(tile) : tiles.erase(tile);
  return tiles;
}

// What the archives know together of the blocks of a tile.
MapBlocks
mergeTile(const Archives& archives, const TileBlocks& tile, const ArchiveHeader& header)
{
  std::map<VoxelIndex, std::vector<const VoxelBlock*>, VoxelIndexLess> sources;
  std::vector<std::vector<std::unique_ptr<VoxelBlock>>> owned;
  for (const auto& [i, indices] : tile.of) {
    owned.push_back(archives[i]->read(indices));
    for (std::size_t k = 0; k < indices.size(); ++k)
      if (owned.back()[k])
        sources[indices[k]].push_back(owned.back()[k].get());
  }
  MapBlocks merged(sources.size());
  std::vector<const std::vector<const VoxelBlock*>*> known;
  for (const auto& [index, blocks] : sources) {
    merged[known.size()].first = index;
    known.push_back(&blocks);
  }
  ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 16)
  for (std::size_t b = 0; b < merged.size(); ++b)
    guard.run([&] {
      merged[b].second = known[b]->size() == 1
                             ? *known[b]->front()
                             : mergeBlocks(*known[b], header.label_set.size(),
                                           header.parameters.fusion);
    });
  guard.rethrow();
  return merged;
}

} // namespace

std::uint64_t
mergeArchives(const std::vector<PlacedArchive>& inputs, const std::string& output,
              const MergeOptions& options)
{
  if (inputs.size() < 2)
    badParameter("expected two or more archives to merge");
  Archives archives;
  for (const PlacedArchive& input : inputs) {
    archives.push_back(std::make_unique<MovedArchive>(input.path, input.motion));
    requireSame(archives.front()->archive(), archives.back()->archive());
  }
  const auto tiles = tilesOf(archives, options.halo);
  std::uint64_t blocks = 0;
  makeArchiveFile(output, [&](const std::string& temporary) {
    const auto merged = MapArchive::create(temporary, headerOf(archives));
    std::size_t done = 0;
    for (const auto& [tile, reached] : tiles) {
      MapBlocks known = mergeTile(archives, reached, merged->header());
      if (options.refine)
        options.refine(known);
      for (const auto& [index, block] : known)
        if (tileAt(index.y()) == tile.y && tileAt(index.x()) == tile.x)
          merged->put(index, block);
      if (options.progress)
        options.progress(++done, tiles.size());
    }
    merged->commit(stateOf(archives));
    blocks = merged->state().blocks;
    merged->close();
  });
  return blocks;
}

} // namespace pcl_semantic
