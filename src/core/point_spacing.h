// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Estimates the spacing of points: the step of their grid (voxels), or
 * otherwise the median distance to the fourth nearest neighbour, which equals that step
 * for a grid on a surface. Uses a sample chosen by position, so the order of the points
 * does not matter.
 * \param[in] positions finite
 * \return 0 if there are fewer than five points, or most of them coincide */
float pointSpacing(const Eigen::MatrixXf& positions);

} // namespace pcl_semantic
