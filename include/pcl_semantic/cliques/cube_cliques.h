// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/core/export.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Cliques of the points in the same cube of a regular grid: the simplest
 * generator, for any cloud.
 *
 * A cube covers [k, k + 1) times the edge along each axis of the cloud's frame, so the
 * cube of a point does not depend on other points. Every finite point is in exactly one
 * clique. The cliques are in the order of their cubes: z, then y, then x. */
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

  /** \throws BadInputException that names the point, if one is more than kMaxVoxelIndex
   * edges from the origin */
  std::vector<pcl::PointIndices> generate(const Cloud& cloud) override;

private:
  double edge_;
};

} // namespace pcl_semantic
