// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "crossed_voxels.h"

#include <pcl_semantic/map/map_parameters.h>

namespace pcl_semantic {

/** \brief Computes how much of each ray of a scan clears space, see Clearing.
 *
 * A ray at a grazing angle runs through voxels of the surface long before its end, and
 * must not clear them. For a sensor 1.7 m above a road, a ray of 20 m stays within 0.1
 * m of the road for its last 1.2 m. */
class FreeSpace {
public:
  /** \param[in] hits the voxels with an end point of the scan; must outlive this object
   * \param[in] start voxel of the sensor */
  FreeSpace(Clearing clearing, double voxel_size, const CrossedVoxels& hits,
            const VoxelIndex& start)
      : clearing_(clearing), voxel_size_(voxel_size), hits_(hits), start_(start)
  {}

  /** \brief The fraction of the ray to a point that clears space.
   * \param[in] end voxel of the point; only used if clearing is careful
   * \param[in] length of the ray [m] */
  double fraction(const VoxelIndex& end, double length);

private:
  const Clearing clearing_;
  const double voxel_size_;
  const CrossedVoxels& hits_;
  const VoxelIndex start_;
  VoxelIndex last_ = VoxelIndex::Constant(kMaxVoxelIndex + 1); // of the last query
  bool last_is_level_ = false;
};

/** \brief Whether the scan saw level ground, or another level surface, at a voxel: in
 * the columns around it that belong to its block, hits within four voxels above and
 * below are only in its own layer and the two adjacent ones.
 * \param[in] hits the voxels with an end point of the scan */
bool isLevel(const CrossedVoxels& hits, const VoxelIndex& voxel);

} // namespace pcl_semantic
