// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/map/map_parameters.h>
#include <pcl_semantic/map/semantic_voxel.h>
#include <pcl_semantic/things/map_objects.h>

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The constant part of a map archive. */
struct ArchiveHeader {
  LabelSet label_set;
  MapParameters parameters;
  std::string configuration; ///< sources and parameters of the map, one per line
};

/** \brief State of a map at the last commit of its archive. */
struct ArchiveState {
  Eigen::Vector3d cloud_origin = Eigen::Vector3d::Zero(); ///< world frame [m]
  bool finished = false;        ///< false: the run can be continued
  std::uint64_t blocks = 0;     ///< set by MapArchive::commit
  std::uint64_t key_sum = 0;    ///< sum over the indices of the blocks; set by commit
  std::uint64_t frames = 0;     ///< set by commit
  std::int64_t last_frame = -1; ///< number of the last frame; set by commit
};

/** \brief Progress callback: number of finished blocks and of all blocks. */
using BlockProgress = std::function<void(std::size_t done, std::size_t blocks)>;

/** \brief A stored map: an archive (MapArchive), or a tiled map with an index of
 * writeTileIndex().
 *
 * Methods throw BadInputException with the name of a damaged file. Tiled maps are not
 * thread-safe. */
class MapReader {
public:
  /** \brief Opens an archive or an index of tiles. */
  static std::unique_ptr<MapReader> open(const std::string& path);

  virtual ~MapReader() = default;

  /** \brief Reads blocks, decompressed in parallel; null for missing blocks. */
  virtual std::vector<std::unique_ptr<VoxelBlock>>
  get(const std::vector<VoxelIndex>& blocks) const = 0;

  /** \brief Visits every block in the order z, y, x of the indices; for a tiled map,
   * this order holds within each tile. */
  virtual void forEach(
      const std::function<void(const VoxelIndex&, const VoxelBlock&)>& visit) const = 0;

  /** \brief Visits the indices of all blocks in the order of forEach(). */
  virtual void
  forEachIndex(const std::function<void(const VoxelIndex&)>& visit) const = 0;

  /** \brief Whether there is a block; fast. */
  virtual bool contains(const VoxelIndex& block) const = 0;

  virtual const std::string& path() const = 0;

  virtual const ArchiveHeader& header() const = 0;

  /** \brief State at the last commit. */
  virtual ArchiveState state() const = 0;

  /** \brief Objects at the last commit; nothing if the map was mapped without them. */
  virtual std::optional<MapObjects> objects() const = 0;
};

} // namespace pcl_semantic
