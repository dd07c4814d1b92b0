// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "voxel_fusion.h"

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/core/voxel_index.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief MAP label of the measured distribution of a voxel with a record; kUnlabelled
 * without labels.
 * \param[in] classes L */
Label measuredLabel(const VoxelBlock& block, int offset, int classes);

/** \brief Reads the voxels of blocks as a map returns them. */
class BlockReader {
public:
  /** \param[in] classes L */
  BlockReader(int classes, const MapParameters& parameters)
      : classes_(classes), voxel_size_(parameters.voxel_size),
        occupancy_(parameters.fusion)
  {}

  /** \brief Whether a voxel is occupied; a voxel without a hit never is. */
  bool
  isOccupied(const VoxelBlock& block, int offset) const
  {
    return block.recordAt(offset) != VoxelBlock::kNoRecord &&
           occupancy_.isOccupied(block.log_odds[offset]);
  }

  Occupancy
  occupancy(const VoxelBlock& block, int offset) const
  {
    if (block.log_odds[offset] == kUnknown)
      return Occupancy::unknown;
    return isOccupied(block, offset) ? Occupancy::occupied : Occupancy::free;
  }

  /** \brief MAP label of an occupied voxel: refined if there is a refined distribution,
   * else measured; kUnlabelled if there is neither. */
  Label label(const VoxelBlock& block, int offset) const;

  VoxelState state(const VoxelIndex& block_index, const VoxelBlock& block,
                   int offset) const;

  std::size_t countOccupied(const VoxelBlock& block) const;

  /** \brief Makes a cloud of \a count voxels.
   * \param[in] voxel_size [m]
   * \param[in] origin of the points, world frame [m] */
  VoxelCloud makeCloud(std::size_t count, double voxel_size,
                       const Eigen::Vector3d& origin) const;

  /** \brief Writes the occupied voxels of a block to a cloud, from voxel \a first on.
   */
  void read(const VoxelIndex& index, const VoxelBlock& block, std::size_t first,
            VoxelCloud& voxels) const;

  /** \brief Reads the occupied voxels of blocks in parallel.
   * \param[in] origin of the points, world frame [m] */
  VoxelCloud
  readAll(const std::vector<std::pair<VoxelIndex, const VoxelBlock*>>& blocks,
          const Eigen::Vector3d& origin) const;

private:
  int classes_;
  double voxel_size_; // [m]
  OccupancyUpdate occupancy_;
};

} // namespace pcl_semantic
