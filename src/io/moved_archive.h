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

/** \brief The blocks of an archive after a rigid motion. Each voxel copies the source
 * voxel that contains its transformed centre, so surfaces get no holes. Hits are moved
 * too, clamped to the voxel. Without a motion the blocks are unchanged. */
class MovedArchive {
public:
  /** \param[in] motion from the world frame of the archive to that of the blocks [m] */
  MovedArchive(const std::string& path, const Eigen::Isometry3d& motion);

  const MapReader&
  archive() const
  {
    return *archive_;
  }

  /** \brief Indices of blocks that may be non-empty, in the order z, y, x.
   * \param[in] is_wanted filter; null = all */
  std::vector<VoxelIndex>
  indices(const std::function<bool(const VoxelIndex&)>& is_wanted = nullptr) const;

  /** \brief Reads blocks in parallel; null for unknown ones.
   * \throws BadInputException if a required block is damaged */
  std::vector<std::unique_ptr<VoxelBlock>>
  read(const std::vector<VoxelIndex>& blocks) const;

private:
  std::unique_ptr<MapReader> archive_;
  bool is_moved_;
  Eigen::Isometry3d motion_; // [voxels]
};

/** \brief Requires that two maps have the same voxel size, labels and fusion.
 * \throws BadInputException that names the difference */
void requireSameKind(const MapReader& first, const MapReader& other);

} // namespace pcl_semantic
