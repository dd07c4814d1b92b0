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

/** \brief An archive and its pose in the merged map. */
struct PlacedArchive {
  std::string path;
  /// T_map_archive [m]. Voxels of a moved archive are resampled: each copies the source
  /// voxel that contains its transformed centre.
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
};

/** \brief The reason why two maps cannot be merged: a different voxel size, label set
 * or fusion clamp; empty if they can. */
std::string differenceOf(const ArchiveHeader& first, const ArchiveHeader& other);

/** \brief Some blocks of a map, in the order z, y, x. */
using MapBlocks = std::vector<std::pair<VoxelIndex, VoxelBlock>>;

struct MergeOptions {
  /// Called with the merged blocks of a tile and \a halo blocks around it, for example
  /// to refine labels. Changes to the halo are discarded.
  std::function<void(MapBlocks& blocks)> refine;
  int halo = 0; ///< width of the surroundings that \a refine gets [blocks]
  BlockProgress progress;
};

/** \brief A square of tile_edge blocks over all heights: the unit of merging in memory.
 */
struct MapTile {
  static constexpr int tile_edge = 32; ///< [blocks]: 25.6 m at voxels of 0.1 m

  int y = 0, x = 0; ///< [tiles]; its first blocks are y * tile_edge and x * tile_edge

  static MapTile of(const VoxelIndex& block);

  bool
  operator<(const MapTile& other) const
  {
    return y != other.y ? y < other.y : x < other.x;
  }
};

/** \brief The tiles that an archive covers after its motion, in order.
 * \throws BadInputException if the archive cannot be read */
std::vector<MapTile> tilesOf(const PlacedArchive& archive);

/** \brief Merges one tile into an archive of its own, as mergeArchives() does.
 *
 * \param[in] inputs one or more, including all that reach the tile and its halo
 * \param[in] output path; an existing file is replaced
 *
 * \throws as mergeArchives() */
void mergeTile(const std::vector<PlacedArchive>& inputs, const MapTile& tile,
               const std::string& output, const MergeOptions& options = {});

/** \brief Path of a tile's archive beside the index of a tiled map. */
std::string tilePath(const std::string& index, const MapTile& tile);

/** \brief Path of the archive with the objects of a tiled map, beside its index. */
std::string tiledObjectsPath(const std::string& index);

/** \brief Merges the objects of the inputs of a tiled map, as mergeArchives() does,
 * into an archive without blocks at tiledObjectsPath(). Replaces an existing file.
 * Removes it if no input has objects.
 * \param[in] index path of the tiled map, which exists
 * \throws as mergeArchives() */
void mergeTiledObjects(const std::vector<PlacedArchive>& inputs,
                       const std::string& index);

/** \brief Joins the archives of tiles into one map: writes the index, a small text file
 * that MapReader::open() reads.
 * \param[in] tiles whose archives are at tilePath(); empty ones are left out
 * \throws BadInputException if an archive cannot be read
 * \throws OutputException if the index cannot be written */
void writeTileIndex(const std::string& index, const std::vector<MapTile>& tiles);

/** \brief Merges maps of the same voxel size, label set and fusion parameters into a
 * new archive, independent of the input order. For voxels in several inputs, log-odds
 * and label logs are added and clamped (unknown voxels add nothing), and colours and
 * counts are summed. Refined distributions are kept only in blocks that a single input
 * has hit. Still objects of one class that touch become one. The result is read-only:
 * no run can continue it. Memory holds one tile with its halo from all inputs, and all
 * objects.
 *
 * \param[in] inputs two or more archives, or one with a motion
 * \param[in] output path that does not exist yet
 *
 * \return number of blocks
 *
 * \throws InvalidParameterException if there is nothing to merge or to move
 * \throws BadInputException that names the difference, or if an archive is damaged
 * \throws OutputException if the file cannot be written */
std::uint64_t mergeArchives(const std::vector<PlacedArchive>& inputs,
                            const std::string& output,
                            const MergeOptions& options = {});

} // namespace pcl_semantic
