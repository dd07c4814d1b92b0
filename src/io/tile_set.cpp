// SPDX-License-Identifier: BSD-3-Clause
#include "tile_set.h"

#include "core/fail.h"

#include <pcl_semantic/files/atomic_file.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace pcl_semantic {

namespace {

constexpr const char* first_word = "pcl_semantic_tiles";
constexpr int version = 1;

constexpr std::size_t max_open = 16; // archives

// "tiles/3_-1.map", as writeTileIndex() names it.
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

void
writeTileIndex(const std::string& index, const std::vector<MapTile>& tiles)
{
  std::ostringstream lines;
  std::uint64_t blocks = 0, tiles_with_blocks = 0;
  for (const MapTile& tile : tiles) {
    const MapArchive archive(tilePath(index, tile), ArchiveAccess::read);
    if (archive.state().blocks == 0)
      continue; // what reached it was moved, and had nothing there
    blocks += archive.state().blocks;
    ++tiles_with_blocks;
    lines << tile.x << " " << tile.y << "\n";
  }
  std::ostringstream text;
  text << first_word << " " << version << " " << tiles_with_blocks << " " << blocks
       << "\n"
       << lines.str();
  writeTextFile(index, text.str());
}

bool
TileSet::isIndex(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  std::string begin(std::string(first_word).size(), ' ');
  file.read(begin.data(), std::streamsize(begin.size()));
  return file && begin == first_word;
}

TileSet::TileSet(const std::string& path) : path_(path)
{
  std::ifstream file(path);
  std::string word;
  int its_version = 0;
  std::size_t tiles = 0;
  file >> word >> its_version >> tiles >> state_.blocks;
  if (!file || its_version != version)
    badInput(path, ", line 1: is no index of tiles of version ", version);
  for (std::size_t i = 0; i < tiles; ++i) {
    MapTile tile;
    if (!(file >> tile.x >> tile.y))
      badInput(path, ", line ", i + 2, ": expected two numbers, of ", tiles, " tiles");
    paths_[tile] = tilePath(path, tile);
  }
  if (paths_.size() != tiles || !(file >> std::ws).eof())
    badInput(path, ": has other tiles than the ", tiles, " it speaks of");
  if (paths_.empty())
    badInput(path, ": has no tiles");
  const MapArchive first(paths_.begin()->second, ArchiveAccess::read);
  header_ = first.header();
  state_.cloud_origin = first.state().cloud_origin;
  state_.finished = true;
}

std::vector<std::string>
TileSet::paths() const
{
  std::vector<std::string> paths;
  for (const auto& [tile, path] : paths_)
    paths.push_back(path);
  return paths;
}

const MapArchive*
TileSet::archiveOf(const VoxelIndex& block) const
{
  const MapTile tile = MapTile::of(block);
  const auto path = paths_.find(tile);
  if (path == paths_.end())
    return nullptr;
  auto& archive = open_[tile];
  if (!archive) {
    auto opened = std::make_unique<MapArchive>(path->second, ArchiveAccess::read);
    if (open_.size() > max_open)
      open_.clear();
    return (open_[tile] = std::move(opened)).get();
  }
  return archive.get();
}

void
TileSet::forEachArchive(const std::function<void(const MapArchive&)>& visit) const
{
  for (const auto& [tile, path] : paths_)
    visit(MapArchive(path, ArchiveAccess::read));
}

} // namespace pcl_semantic
