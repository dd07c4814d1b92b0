// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "crossed_voxels.h"

#include <pcl_semantic/map/map_parameters.h>

namespace pcl_semantic {

/** \brief Says how much of each ray of a scan shows that space is free, see Clearing.
 *
 * A ray that meets a surface at a small angle runs through voxels of that surface long
 * before it ends, and must not be taken for a witness against them: at a sensor 1.7 m
 * above a road, a ray of 20 m stays within 0.1 m of the road for its last 1.2 m. */
class FreeSpace {
public:
  /** \param[in] hits the voxels that hold an end of the scan; has to outlive this
   * \param[in] start voxel of the sensor */
  FreeSpace(Clearing clearing, double voxel_size, const CrossedVoxels& hits,
            const VoxelIndex& start)
      : clearing_(clearing), voxel_size_(voxel_size), hits_(hits), start_(start)
  {}

  /** \brief The fraction of the way to a point that is free.
   * \param[in] end voxel of the point; only read if clearing is careful
   * \param[in] length of the way [m] */
  double fraction(const VoxelIndex& end, double length);

private:
  const Clearing clearing_;
  const double voxel_size_;
  const CrossedVoxels& hits_;
  const VoxelIndex start_;
  VoxelIndex last_ = VoxelIndex::Constant(kMaxVoxelIndex + 1); // asked for
  bool last_is_level_ = false;
};

/** \brief Whether the scan saw level ground, or the level top of something, at a voxel:
 * up to four voxels above and below, nothing was hit but in its own layer and the two
 * next to it. Looks at the columns of voxels around it that belong to its block.
 * \param[in] hits the voxels that hold an end of the scan */
bool isLevel(const CrossedVoxels& hits, const VoxelIndex& voxel);

} // namespace pcl_semantic
