// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/core/export.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Cliques of the points that share a cube of a regular grid: the simplest that
 * work on any cloud.
 *
 * A cube covers [k, k + 1) times the edge in each axis of the cloud's frame, so a point
 * stays in its cube when others come or go. Every finite point is in exactly one
 * clique; the cliques come in the order of their cubes: z, then y, then x. */
class CubeCliques : public CliqueGenerator {
public:
  /** \param[in] edge of a cube [m]
   * \throws InvalidParameterException unless it is finite and positive */
  explicit CubeCliques(double edge = 1.0);

  double
  edge() const
  {
    return edge_;
  }

  /** \throws BadInputException that names the point, if one is more than
   * kMaxVoxelIndex edges from the origin */
  std::vector<pcl::PointIndices> generate(const Cloud& cloud) override;

private:
  double edge_;
};

} // namespace pcl_semantic
