// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Finds the connected components of points: two points are connected if their
 * distance is at most \a gap.
 *
 * The points are sorted into cubes with a diagonal of \a gap, so all points of a cube
 * are connected. Only pairs of cubes are compared, and only until a pair of points is
 * near enough. The result is exact.
 *
 * \param[in] points finite positions [m]
 * \param[in] gap [m]
 * \return the component of each point: 0, 1, ..., in the order of the lowest point of
 * each component (by z, y, x). It does not depend on the order of the points
 * \throws InvalidParameterException unless \a gap is finite and positive
 * \throws BadInputException if the points extend over more than 2^20 cubes */
std::vector<int> connectedComponents(const std::vector<Eigen::Vector3d>& points,
                                     double gap);

} // namespace pcl_semantic
