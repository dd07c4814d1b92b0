// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <functional>

namespace pcl_semantic {

/** \brief Minimises a smooth convex function by limited-memory BFGS (Nocedal and
 * Wright, "Numerical Optimization", algorithm 7.5) with backtracking.
 * \param[in] function returns the value at a position and writes its gradient
 * \param[in] start of the search
 * \param[in] iterations maximum
 * \param[in] tolerance for the largest entry of the gradient */
Eigen::VectorXd minimizeConvex(
    const std::function<double(const Eigen::VectorXd&, Eigen::VectorXd&)>& function,
    Eigen::VectorXd start, int iterations, double tolerance);

} // namespace pcl_semantic
