// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <functional>

namespace pcl_semantic {

/** \brief Minimum of a smooth convex function by limited-memory BFGS (Nocedal and
 * Wright, "Numerical Optimization", algorithm 7.5) with backtracking.
 * \param[in] function gives the value at a position and writes its gradient
 * \param[in] start where the search begins
 * \param[in] iterations at most
 * \param[in] tolerance ends when no entry of the gradient is larger */
Eigen::VectorXd minimizeConvex(
    const std::function<double(const Eigen::VectorXd&, Eigen::VectorXd&)>& function,
    Eigen::VectorXd start, int iterations, double tolerance);

} // namespace pcl_semantic
