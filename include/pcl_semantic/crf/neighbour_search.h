/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/core/abi_check.h>

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief The points within a radius of every point, in compressed rows. */
struct NeighbourLists {
  std::vector<std::size_t> starts;      ///< first neighbour of each point, N + 1
  std::vector<std::int32_t> neighbours; ///< without the point itself
};

/** \brief Finds all pairs of points within a radius (and up to 1e-4 of it beyond), by
 * sorting the points into cells.
 * \param[in] positions 3 x N, finite
 * \param[in] radius positive, in the unit of the positions
 * \throws InvalidParameterException at more than 2^31 pairs, or positions too far apart
 * for the radius */
NeighbourLists findNeighbours(const Eigen::Matrix3Xf& positions, float radius);

} // namespace pcl_semantic
