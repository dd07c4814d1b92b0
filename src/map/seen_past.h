// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ray_caster.h"

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/map/map_parameters.h>
#include <pcl_semantic/map/scan.h>

#include <Eigen/Geometry>

#include <cstddef>

namespace pcl_semantic {

/** \brief Frees the voxels of dynamic classes that a scan sees past, so that moving
 * objects leave no trail.
 *
 * A scan sees past an occupied voxel if no ray ends in it, none ends in its 26
 * neighbours on its class or on no class, and at least two rays pass through it and end
 * behind it by max(3 deviations, 1 m) or more, on another class. One such scan frees
 * the voxel, unless 3 deviations of its own depth exceed 1 m. Voxels that no ray passes
 * keep their state. A free voxel loses its colour and its labels.
 *
 * Counts of rays are sums, so the result depends neither on the order of the points nor
 * on the number of threads.
 * \param[in] caster has cast \a scan last, and the blocks of \a grid are updated
 * \return number of voxels that became free */
std::size_t freeSeenPast(const LabelSet& label_set, const MapParameters& parameters,
                         const Scan& scan, const Eigen::Isometry3d& T_world_sensor,
                         const RayCaster& caster, RayCaster::Grid& grid);

} // namespace pcl_semantic
