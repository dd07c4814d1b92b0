// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief How far apart points are: the step of their grid (voxels), or else the median
 * distance to the fourth nearest neighbour, which would be that step in a grid on a
 * surface. Measured at some of the points, chosen by their positions, so that their
 * order does not matter.
 * \param[in] positions finite
 * \return 0 if there are fewer than five points, or most of them lie on one another */
float pointSpacing(const Eigen::MatrixXf& positions);

} // namespace pcl_semantic
