// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "surface_cells.h"

#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief Limits of region growing. */
struct PlaneLimits {
  double angle = 0.0;    ///< between normals [rad]
  double distance = 0.0; ///< of a cell's mean from the plane [m]
  double gap = 0.0;      ///< between parts of one plane [m]
  double area = 0.0;     ///< minimum of a plane [m^2]
  double square = 0.0;   ///< edge of the squares in which the area is counted [m]
};

/** \brief A plane and its cells, ascending. */
struct GrownPlane {
  FittedPlane plane;
  std::vector<std::int32_t> cells;
};

/** \brief Finds planes by region growing: the flattest cell begins, neighbours join
 * whose normal and mean fit the plane, and the plane is fitted again until it stops
 * growing. Parts of one plane are merged. A cell is in at most one plane.
 * \return planes, the one with most cells first */
std::vector<GrownPlane> growPlanes(const SurfaceCells& cells,
                                   const PlaneLimits& limits);

} // namespace pcl_semantic
