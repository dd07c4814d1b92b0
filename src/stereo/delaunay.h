// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

namespace pcl_semantic {

/** \brief A point with integer coordinates, from -8192 to 8192. */
struct GridPoint {
  int u = 0, v = 0;
};

/** \brief Delaunay triangulation by divide and conquer (L. Guibas, J. Stolfi,
 * Primitives for the manipulation of general subdivisions and the computation of
 * Voronoi diagrams, ACM Transactions on Graphics 1985). Exact, by integer arithmetic.
 * \param[in] points distinct, sorted by u, then by v
 * \return corners of every triangle as indices, all of one orientation; empty if all
 * points are collinear */
std::vector<std::array<int, 3>> triangulate(const std::vector<GridPoint>& points);

} // namespace pcl_semantic
