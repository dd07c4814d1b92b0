// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/io/map_reader.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <Eigen/Geometry>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief The blocks of an archive after a rigid motion. Each voxel is a copy of the
 * one that its centre comes from, with the hits where they are now (but no further than
 * its walls); so surfaces get no holes. Without a motion the blocks are those of the
 * archive.
 */
class MovedArchive {
public:
  /** \param[in] motion from the world frame of the archive to that of the blocks [m] */
  MovedArchive(const std::string& path, const Eigen::Isometry3d& motion);

  const MapReader&
  archive() const
  {
    return *archive_;
  }

  /** \brief Blocks that may hold something, in the order z, y, x.
   * \param[in] is_wanted leaves out the others; null = all */
  std::vector<VoxelIndex>
  indices(const std::function<bool(const VoxelIndex&)>& is_wanted = nullptr) const;

  /** \brief Blocks, by all threads; null where nothing is known.
   * \throws BadInputException if one that is needed is damaged */
  std::vector<std::unique_ptr<VoxelBlock>>
  read(const std::vector<VoxelIndex>& blocks) const;

private:
  std::unique_ptr<MapReader> archive_;
  bool is_moved_;
  Eigen::Isometry3d motion_; // [voxels]
};

/** \brief Makes sure that two maps have voxels, labels and fusion in common.
 * \throws BadInputException that names what differs */
void requireSameKind(const MapReader& first, const MapReader& other);

} // namespace pcl_semantic
