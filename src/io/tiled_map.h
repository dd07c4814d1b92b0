// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/io/archive_merge.h>
#include <pcl_semantic/io/map_archive.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief A tiled map: one archive per tile, listed in a text file of writeTileIndex().
 * Only a few are open at a time. */
class TiledMap : public MapReader {
public:
  /** \brief Whether a file is such an index. */
  static bool isIndex(const std::string& path);

  /** \throws BadInputException with the line, or if a tile cannot be read */
  explicit TiledMap(const std::string& path);

  std::vector<std::unique_ptr<VoxelBlock>>
  get(const std::vector<VoxelIndex>& blocks) const override;

  void forEach(const std::function<void(const VoxelIndex&, const VoxelBlock&)>& visit)
      const override;

  void forEachIndex(const std::function<void(const VoxelIndex&)>& visit) const override;

  bool contains(const VoxelIndex& block) const override;

  const std::string&
  path() const override
  {
    return path_;
  }

  const ArchiveHeader&
  header() const override
  {
    return header_;
  }

  ArchiveState
  state() const override
  {
    return state_;
  }

  std::optional<MapObjects> objects() const override;

  /** \brief See verifyArchive(). */
  std::vector<std::string> faults(const BlockProgress& progress) const;

private:
  std::string path_; // of the index
  struct Tile {
    std::string path;
    std::uint64_t blocks = 0, key_sum = 0; // of its archive's state
  };

  std::unique_ptr<MapArchive> open(const MapTile& tile) const;

  /** \brief The archive whose tile contains a block; null: there is none. */
  const MapArchive* archiveOf(const VoxelIndex& block) const;

  std::map<MapTile, Tile> tiles_;
  ArchiveHeader header_;
  ArchiveState state_;
  mutable std::map<MapTile, std::unique_ptr<MapArchive>> open_;
};

} // namespace pcl_semantic
