// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/io/map_archive.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <Eigen/Geometry>

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief An archive, and where it belongs in a map of several. */
struct PlacedArchive {
  std::string path;
  /// From its world frame to that of the map [m]. Voxels that it moves are resampled:
  /// each is a copy of the one that its centre comes from.
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
};

/** \brief The reason why maps of two headers cannot be merged: voxel size, label set or
 * clamps of the fusion, as words; empty if nothing does. */
std::string differenceOf(const ArchiveHeader& first, const ArchiveHeader& other);

/** \brief Some blocks of a map, in the order z, y, x. */
using MapBlocks = std::vector<std::pair<VoxelIndex, VoxelBlock>>;

struct MergeOptions {
  /// Called with what was merged of a square of space and \a halo blocks around it, to
  /// change it: refine its labels, say. What it makes of the halo is dropped.
  std::function<void(MapBlocks& blocks)> refine;
  int halo = 0; ///< [blocks]
  BlockProgress progress;
};

/** \brief A square of space over all heights, an edge of tile_edge blocks: what merging
 * has in memory at a time. */
struct MapTile {
  static constexpr int tile_edge = 32; ///< [blocks]: 25.6 m at voxels of 0.1 m

  int y = 0, x = 0; ///< [tiles]; blocks y * tile_edge and x * tile_edge are its first

  /** \brief The one that holds a block. */
  static MapTile of(const VoxelIndex& block);

  bool
  operator<(const MapTile& other) const
  {
    return y != other.y ? y < other.y : x < other.x;
  }
};

/** \brief The tiles that hold blocks of an archive after its motion, in order.
 * \throws BadInputException */
std::vector<MapTile> tilesOf(const PlacedArchive& archive);

/** \brief Merges one tile into an archive of its own, as mergeArchives() does.
 *
 * \param[in] inputs one or more, among them all that reach the tile and its halo
 * \param[in] output path; what is there is replaced
 *
 * \throws as mergeArchives() */
void mergeTile(const std::vector<PlacedArchive>& inputs, const MapTile& tile,
               const std::string& output, const MergeOptions& options = {});

/** \brief Path of the archive of a tile, beside the index of a map in tiles. */
std::string tilePath(const std::string& index, const MapTile& tile);

/** \brief Makes the archives of tiles one map: MapReader::open() reads the index, a
 * small text file, as it reads an archive. \param[in] tiles whose archives lie at
 * tilePath(); empty ones are left out \throws BadInputException, OutputException */
void writeTileIndex(const std::string& index, const std::vector<MapTile>& tiles);

/** \brief Joins maps of the same voxel size, label set and fusion parameters into a new
 * archive, which does not depend on their order. Where several know a voxel, log-odds
 * and label logs are added and clamped, what is unknown adds nothing, colours and
 * counts are summed; refined distributions are kept in blocks where only one has hit
 * anything. The result is a map to read; no run goes on with it. Memory holds a tile
 * and its halo, with what all inputs know there.
 *
 * \param[in] inputs two or more archives, or one that is moved
 * \param[in] output path of one that is not there yet
 *
 * \return number of blocks
 *
 * \throws InvalidParameterException if there is nothing to merge or to move
 * \throws BadInputException that says what differs, or if one is damaged
 * \throws OutputException */
std::uint64_t mergeArchives(const std::vector<PlacedArchive>& inputs,
                            const std::string& output,
                            const MergeOptions& options = {});

} // namespace pcl_semantic
