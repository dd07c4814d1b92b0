// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/archive_merge.h>

#include "archive_database.h"
#include "block_merge.h"
#include "core/fail.h"
#include "core/parallel_guard.h"
#include "core/split.h"
#include "moved_archive.h"
#include "object_merge.h"

#include <pcl_semantic/core/exceptions.h>

#include <pcl_semantic/io/map_archive.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

namespace pcl_semantic {

namespace {

using Archives = std::vector<std::unique_ptr<MovedArchive>>;

// Description of a merge's inputs, one per line.
std::string
describeMerge(std::vector<PlacedArchive> inputs)
{
  std::sort(inputs.begin(), inputs.end(),
            [](const auto& a, const auto& b) { return a.path < b.path; });
  TextStream text;
  text.precision(17);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    text << "merged_" << i + 1 << ": " << inputs[i].path << "\n";
    if (inputs[i].motion.matrix() == Eigen::Matrix4d::Identity())
      continue;
    text << "moved_" << i + 1 << ":";
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column)
        text << " " << inputs[i].motion(row, column);
    text << "\n";
  }
  return text.str();
}

// The constant part of an input and its state, without its blocks.
struct Described {
  std::string path;
  ArchiveHeader header;
  ArchiveState state;
};

Described
describe(const MapReader& archive)
{
  return {archive.path(), archive.header(), archive.state()};
}

std::vector<Described>
describeAll(const Archives& archives)
{
  std::vector<Described> all;
  for (const auto& archive : archives)
    all.push_back(describe(archive->archive()));
  return all;
}

// The header of the first input by name, independent of the input order.
ArchiveHeader
headerOf(const std::vector<Described>& archives,
         const std::vector<PlacedArchive>& inputs)
{
  const Described& first = *std::min_element(
      archives.begin(), archives.end(),
      [](const Described& a, const Described& b) { return a.path < b.path; });
  ArchiveHeader header = first.header;
  for (const Described& archive : archives) {
    const MapParameters& parameters = archive.header.parameters;
    header.parameters.window = header.parameters.window.cwiseMax(parameters.window);
    header.parameters.max_range =
        std::max(header.parameters.max_range, parameters.max_range);
    // Labels without a weight have no deviations.
    header.parameters.fusion.weigh_labels &= parameters.fusion.weigh_labels;
  }
  header.configuration = describeMerge(inputs);
  for (const std::string_view line : splitAt('\n', first.header.configuration))
    if (line.rfind("crf", 0) == 0) // parameters to refine a later merge of the result
      header.configuration += std::string(line) + "\n";
  return header;
}

ArchiveState
stateOf(const std::vector<Described>& archives)
{
  const auto less = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  ArchiveState state;
  state.cloud_origin = archives.front().state.cloud_origin;
  state.finished = true;
  for (const Described& archive : archives) {
    state.finished = state.finished && archive.state.finished;
    if (less(archive.state.cloud_origin, state.cloud_origin))
      state.cloud_origin = archive.state.cloud_origin;
  }
  return state;
}

// The objects of inputs, by their names.
class ObjectInputs {
public:
  void
  add(const MapReader& archive, const Eigen::Isometry3d& motion)
  {
    std::optional<MapObjects> objects = archive.objects();
    if (!objects)
      return;
    Eigen::Isometry3d in_voxels = motion;
    in_voxels.translation() /= archive.header().parameters.voxel_size;
    placed_[archive.path()] = {std::move(*objects), in_voxels};
  }

  // Those with enough voxels in the merged map; nothing if no input has objects.
  std::optional<MapObjects>
  mergeFor(const MapReader& merged)
  {
    if (placed_.empty())
      return {};
    std::vector<PlacedObjects> maps;
    for (auto& [path, objects] : placed_)
      maps.push_back(std::move(objects));
    MapObjects objects = mergeObjects(maps);
    keepVisible(merged, objects);
    return objects;
  }

private:
  std::map<std::string, PlacedObjects> placed_;
};

int
tileAt(int block)
{
  return int(std::floor(double(block) / MapTile::tile_edge));
}

// By archive, the blocks of a tile and its halo.
struct TileBlocks {
  bool is_reached = false; // by an archive, not only in its halo
  std::map<std::size_t, std::vector<VoxelIndex>> of;
};

std::map<MapTile, TileBlocks>
tilesOf(const Archives& archives, int halo)
{
  std::map<MapTile, TileBlocks> tiles;
  for (std::size_t i = 0; i < archives.size(); ++i)
    for (const VoxelIndex& block : archives[i]->indices()) {
      for (int y = tileAt(block.y() - halo); y <= tileAt(block.y() + halo); ++y)
        for (int x = tileAt(block.x() - halo); x <= tileAt(block.x() + halo); ++x)
          tiles[{y, x}].of[i].push_back(block);
      tiles[MapTile::of(block)].is_reached = true;
    }
  for (auto tile = tiles.begin(); tile != tiles.end();)
    tile = tile->second.is_reached ? std::next(tile) : tiles.erase(tile);
  return tiles;
}

// The merged blocks of a tile.
MapBlocks
knownIn(const Archives& archives, const TileBlocks& tile, const ArchiveHeader& header)
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
      merged[b].second =
          known[b]->size() == 1
              ? *known[b]->front()
              : mergeBlocks(*known[b], header.label_set, header.parameters.fusion);
    });
  guard.rethrow();
  return merged;
}

Archives
openAll(const std::vector<PlacedArchive>& inputs)
{
  Archives archives;
  for (const PlacedArchive& input : inputs) {
    archives.push_back(std::make_unique<MovedArchive>(input.path, input.motion));
    requireSameKind(archives.front()->archive(), archives.back()->archive());
  }
  return archives;
}

void
putTile(const Archives& archives, const MapTile& tile, const TileBlocks& reached,
        const MergeOptions& options, MapArchive& merged)
{
  MapBlocks known = knownIn(archives, reached, merged.header());
  if (options.refine)
    options.refine(known);
  for (const auto& [index, block] : known) {
    const MapTile its = MapTile::of(index);
    if (!(its < tile || tile < its))
      merged.put(index, block);
  }
}

TileBlocks
blocksOf(const Archives& archives, const MapTile& tile, int halo)
{
  const auto isNear = [&](int block, int position) {
    return block >= position * MapTile::tile_edge - halo &&
           block < (position + 1) * MapTile::tile_edge + halo;
  };
  TileBlocks found;
  for (std::size_t i = 0; i < archives.size(); ++i)
    found.of[i] = archives[i]->indices([&](const VoxelIndex& block) {
      return isNear(block.y(), tile.y) && isNear(block.x(), tile.x);
    });
  return found;
}

} // namespace

MapTile
MapTile::of(const VoxelIndex& block)
{
  return {tileAt(block.y()), tileAt(block.x())};
}

std::vector<MapTile>
tilesOf(const PlacedArchive& archive)
{
  std::set<MapTile> tiles;
  for (const VoxelIndex& block : MovedArchive(archive.path, archive.motion).indices())
    tiles.insert(MapTile::of(block));
  return {tiles.begin(), tiles.end()};
}

namespace {

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

} // namespace

std::string
differenceOf(const ArchiveHeader& first, const ArchiveHeader& other)
{
  if (first.parameters.voxel_size != other.parameters.voxel_size)
    return "voxel size";
  if (!areSame(first.label_set, other.label_set))
    return "label set";
  // The clamps limit the sums and determine the meaning of the result.
  const auto clamps = [](const FusionParameters& fusion) {
    return std::tie(fusion.min_probability, fusion.max_probability,
                    fusion.occupied_probability, fusion.label_max_ratio);
  };
  if (clamps(first.parameters.fusion) != clamps(other.parameters.fusion))
    return "min_probability, max_probability, occupied_probability or label_max_ratio";
  return {};
}

void
mergeTile(const std::vector<PlacedArchive>& inputs, const MapTile& tile,
          const std::string& output, const MergeOptions& options)
{
  if (inputs.empty())
    badParameter("expected archives to merge");
  const Archives archives = openAll(inputs);
  std::filesystem::remove(output);
  makeArchiveFile(output, [&](const std::string& temporary) {
    const std::vector<Described> described = describeAll(archives);
    const auto merged = MapArchive::create(temporary, headerOf(described, inputs));
    putTile(archives, tile, blocksOf(archives, tile, options.halo), options, *merged);
    merged->commit(stateOf(described));
    merged->close();
  });
}

void
mergeTiledObjects(const std::vector<PlacedArchive>& inputs, const std::string& index)
{
  const std::string path = tiledObjectsPath(index);
  std::filesystem::remove(path);
  std::vector<Described> described;
  ObjectInputs objects;
  for (const PlacedArchive& input : inputs) { // one at a time is open
    const auto archive = MapReader::open(input.path);
    described.push_back(describe(*archive));
    objects.add(*archive, input.motion);
  }
  const auto merged_objects = objects.mergeFor(*MapReader::open(index));
  if (!merged_objects)
    return;
  makeArchiveFile(path, [&](const std::string& temporary) {
    const auto merged = MapArchive::create(temporary, headerOf(described, inputs));
    merged->putObjects(*merged_objects);
    merged->commit(stateOf(described));
    merged->close();
  });
}

std::uint64_t
mergeArchives(const std::vector<PlacedArchive>& inputs, const std::string& output,
              const MergeOptions& options)
{
  if (inputs.empty() ||
      (inputs.size() == 1 && inputs[0].motion.matrix() == Eigen::Matrix4d::Identity()))
    badParameter("expected two or more archives to merge, or one to move");
  const Archives archives = openAll(inputs);
  const auto tiles = tilesOf(archives, options.halo);
  std::uint64_t blocks = 0;
  makeArchiveFile(output, [&](const std::string& temporary) {
    const std::vector<Described> described = describeAll(archives);
    const auto merged = MapArchive::create(temporary, headerOf(described, inputs));
    std::size_t done = 0;
    for (const auto& [tile, reached] : tiles) {
      putTile(archives, tile, reached, options, *merged);
      if (options.progress)
        options.progress(++done, tiles.size());
    }
    ObjectInputs objects;
    for (std::size_t i = 0; i < inputs.size(); ++i)
      objects.add(archives[i]->archive(), inputs[i].motion);
    if (const std::optional<MapObjects> merged_objects = objects.mergeFor(*merged))
      merged->putObjects(*merged_objects);
    merged->commit(stateOf(described));
    blocks = merged->state().blocks;
    merged->close();
  });
  return blocks;
}

} // namespace pcl_semantic
