// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/quantized_point.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Visits the voxels that the closed segment crosses, from that on which enters
 * slab \a slab: the one that lies \a slab voxels from the start along \a axis. In
 * order, and exact as traverseSegment(); nothing if the segment ends before. \param[in]
 * axis 0, 1 or 2; the segment has an extent along it unless \a slab is 0 \param[in]
 * visit called with a VoxelIndex; returns false to stop \return false if \a visit
 * stopped it */
template <typename Visit>
bool traverseSegmentFrom(const QuantizedPoint& from, const QuantizedPoint& to, int axis,
                         int slab, Visit&& visit);

/** \brief Visits every voxel that the closed segment crosses and no other, in order, by
 * exact integer arithmetic (Amanatides and Woo 1987 with rational times).
 *
 * Voxels are half open: a segment through an edge or a corner enters only the voxels
 * that hold one of its points.
 * \param[in] visit called with a VoxelIndex; returns false to stop
 * \return false if \a visit stopped it */
template <typename Visit>
bool traverseSegment(const QuantizedPoint& from, const QuantizedPoint& to,
                     Visit&& visit);

} // namespace pcl_semantic

#include <pcl_semantic/map/impl/ray_traversal.hpp>
