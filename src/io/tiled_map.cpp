// SPDX-License-Identifier: BSD-3-Clause
#include "tiled_map.h"

#include "core/fail.h"
#include "core/parse_whole.h"
#include "core/split.h"
#include "files/is_there.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>

#include <filesystem>
#include <fstream>

namespace pcl_semantic {

namespace {

constexpr const char* first_word = "pcl_semantic_tiles";
constexpr int version = 1;

constexpr std::size_t max_open = 16; // archives

// "tiles/3_-1.map", as in writeTileIndex().
std::string
nameOf(const MapTile& tile)
{
  return "tiles/" + std::to_string(tile.x) + "_" + std::to_string(tile.y) + ".map";
}

} // namespace

std::string
tilePath(const std::string& index, const MapTile& tile)
{
  return (std::filesystem::path(index).parent_path() / nameOf(tile)).string();
}

std::string
tiledObjectsPath(const std::string& index)
{
  return (std::filesystem::path(index).parent_path() / "objects.map").string();
}

void
writeTileIndex(const std::string& index, const std::vector<MapTile>& tiles)
{
  TextStream lines;
  std::uint64_t blocks = 0, tiles_with_blocks = 0;
  for (const MapTile& tile : tiles) {
    const MapArchive archive(tilePath(index, tile), ArchiveAccess::read);
    if (archive.state().blocks == 0)
      continue; // its moved inputs had no content here
    blocks += archive.state().blocks;
    ++tiles_with_blocks;
    lines << tile.x << " " << tile.y << " " << archive.state().blocks << " "
          << archive.state().key_sum << "\n";
  }
  TextStream text;
  text << first_word << " " << version << " " << tiles_with_blocks << " " << blocks
       << "\n"
       << lines.str();
  writeTextFile(index, text.str());
}

bool
TiledMap::isIndex(const std::string& path)
{
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    return false; // opening a pipe would block
  std::ifstream file(path, std::ios::binary);
  std::string begin(std::string(first_word).size(), ' ');
  file.read(begin.data(), std::streamsize(begin.size()));
  return file && begin == first_word;
}

TiledMap::TiledMap(const std::string& path) : path_(path)
{
  std::size_t tiles = 0;
  std::uint64_t blocks = 0;
  for (const TextLine& line : readLines(path)) {
    const std::vector<std::string_view> words = wordsOf(line.text);
    if (line.number == 1) {
      int its_version = 0;
      if (words.size() != 4 || words[0] != first_word ||
          !parseWhole(words[1], its_version) || its_version != version ||
          !parseWhole(words[2], tiles) || !parseWhole(words[3], state_.blocks))
        badInput(atLine(path, 1), ": is no index of tiles of version ", version);
      continue;
    }
    MapTile tile;
    Tile its;
    if (words.size() != 4 || !parseWhole(words[0], tile.x) ||
        !parseWhole(words[1], tile.y) || !parseWhole(words[2], its.blocks) ||
        !parseWhole(words[3], its.key_sum))
      badInput(atLine(path, line.number), ": expected four numbers in each row of ",
               tiles, " tiles");
    blocks += its.blocks;
    its.path = tilePath(path, tile);
    tiles_[tile] = its;
  }
  if (tiles_.size() != tiles || blocks != state_.blocks)
    badInput(path, ": has ", tiles_.size(), " tiles of ", blocks, " blocks, expected ",
             tiles, " of ", state_.blocks);
  if (tiles_.empty())
    badInput(path, ": has no tiles");
  const auto first = open(tiles_.begin()->first);
  header_ = first->header();
  state_.cloud_origin = first->state().cloud_origin;
  state_.finished = true;
}

// Verifies that its blocks are those in the index.
std::unique_ptr<MapArchive>
TiledMap::open(const MapTile& tile) const
{
  const Tile& its = tiles_.at(tile);
  auto archive = std::make_unique<MapArchive>(its.path, ArchiveAccess::read);
  const ArchiveState state = archive->state();
  if (state.blocks != its.blocks || state.key_sum != its.key_sum)
    badInput(its.path, ": is not the tile that ", path_, " lists: it has other blocks");
  return archive;
}

std::vector<std::string>
TiledMap::faults(const BlockProgress& progress) const
{
  std::vector<std::string> faults;
  for (const auto& [tile, its] : tiles_)
    try {
      const std::vector<std::string> own = verifyArchive(its.path, progress);
      faults.insert(faults.end(), own.begin(), own.end());
      if (own.empty())
        open(tile);
    }
    catch (const BadInputException& error) {
      faults.push_back(error.what());
    }
  const std::string archive = tiledObjectsPath(path_);
  if (!isThere(archive))
    return faults;
  const std::vector<std::string> own = verifyArchive(archive);
  faults.insert(faults.end(), own.begin(), own.end());
  try {
    if (own.empty())
      objects();
  }
  catch (const BadInputException& error) {
    faults.push_back(error.what());
  }
  return faults;
}

std::optional<MapObjects>
TiledMap::objects() const
{
  const std::string path = tiledObjectsPath(path_);
  if (!isThere(path))
    return {};
  const MapArchive objects(path, ArchiveAccess::read);
  if (const std::string difference = differenceOf(header_, objects.header());
      !difference.empty())
    badInput(path, ": has another ", difference, " than the tiles of ", path_);
  return objects.objects();
}

const MapArchive*
TiledMap::archiveOf(const VoxelIndex& block) const
{
  const MapTile tile = MapTile::of(block);
  if (tiles_.count(tile) == 0)
    return nullptr;
  const auto found = open_.find(tile);
  if (found != open_.end())
    return found->second.get();
  if (open_.size() >= max_open)
    open_.clear();
  return (open_[tile] = open(tile)).get();
}

std::vector<std::unique_ptr<VoxelBlock>>
TiledMap::get(const std::vector<VoxelIndex>& blocks) const
{
  std::vector<std::unique_ptr<VoxelBlock>> found;
  for (const VoxelIndex& block : blocks) {
    const MapArchive* const archive = archiveOf(block);
    found.push_back(archive ? archive->get(block) : nullptr);
  }
  return found;
}

bool
TiledMap::contains(const VoxelIndex& block) const
{
  const MapArchive* const archive = archiveOf(block);
  return archive && archive->contains(block);
}

void
TiledMap::forEach(
    const std::function<void(const VoxelIndex&, const VoxelBlock&)>& visit) const
{
  for (const auto& [tile, its] : tiles_)
    open(tile)->forEach(visit);
}

void
TiledMap::forEachIndex(const std::function<void(const VoxelIndex&)>& visit) const
{
  for (const auto& [tile, its] : tiles_)
    open(tile)->forEachIndex(visit);
}

} // namespace pcl_semantic
