// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/map/map_parameters.h>
#include <pcl_semantic/map/ray_caster.h>

namespace pcl_semantic {

/** \brief Counts every ray of a scan in the occupancy of its voxels, as the
 * paper does: one after the other by a single thread, for here their order matters.
 * \param[in] scan that \a caster has cast last
 * \param[in,out] grid that the rays were cast through; all crossed blocks are there */
void countRays(const RayCaster& caster, const MapParameters& parameters,
               const Scan& scan, RayCaster::Grid& grid);

} // namespace pcl_semantic
