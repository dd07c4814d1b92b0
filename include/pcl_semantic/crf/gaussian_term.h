// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A weighted Gaussian over positions and, if there are any, further features:
 * w exp(-|p_i - p_j|^2 / 2 sigma^2 - |f_i - f_j|^2 / 2), a term of eq. (6) with the
 * square that the paper's text dropped. */
struct GaussianTerm {
  float weight = 1.0f;
  float position_deviation = 1.0f; ///< sigma, in the unit of the positions
  Eigen::MatrixXf
      features; ///< d x N, divided by their deviations; empty = positions only

  /** \throws InvalidParameterException if the deviation is not positive, the weight
   * negative, the features are not of \a points, or something is not finite */
  void validate(Eigen::Index points) const;
};

} // namespace pcl_semantic
