/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/map/ray_caster.h>
#include <pcl_semantic/map/voxel_fusion.h>

namespace pcl_semantic {

/** \brief Counts every ray of the last scan in the occupancy of its voxels, as the
 * paper does: one after the other by a single thread, for here their order matters.
 * \param[in,out] grid that the rays were cast through; all crossed blocks are there */
void countRays(const RayCaster& caster, const FusionParameters& fusion,
               RayCaster::Grid& grid);

} // namespace pcl_semantic
