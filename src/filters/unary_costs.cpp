/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "unary_costs.h"

namespace pcl_semantic {

Eigen::MatrixXf
unaryCosts(const Eigen::MatrixXf& measured)
{
  constexpr float smallest = 1e-6f;
  Eigen::MatrixXf costs(measured.rows(), measured.cols());
#pragma omp parallel for schedule(static)
  for (Eigen::Index i = 0; i < measured.cols(); ++i) {
    const float sum = measured.col(i).sum();
    if (sum > 0.0f)
      costs.col(i) = -(measured.col(i) / sum).array().max(smallest).log();
    else
      costs.col(i).setZero();
  }
  return costs;
}

} // namespace pcl_semantic
