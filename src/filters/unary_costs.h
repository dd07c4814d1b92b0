/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <Eigen/Core>

namespace pcl_semantic {

/** \brief Costs -log p, eq. (4), of measurements L x N of any positive scale; one that
 * is all zero has no preference. */
Eigen::MatrixXf unaryCosts(const Eigen::MatrixXf& measured);

} // namespace pcl_semantic
