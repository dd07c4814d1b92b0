// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kernels/truncated_sums.h"

#include <pcl_semantic/crf/gaussian_term.h>

#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief Positions and features of points in some order, and the scales of the terms,
 * as the arrays that the inner loops take. */
class SortedPoints {
public:
  /** \param[in] order numbers of the columns of \a positions
   * \param[in] squared_radius pairs farther apart are none
   * \param[in] variance of positions, in all terms */
  SortedPoints(const Eigen::Matrix3Xf& positions,
               const std::vector<std::int32_t>& order,
               const std::vector<GaussianTerm>& terms, float squared_radius,
               float variance);
  SortedPoints(const SortedPoints&) = delete; // views point into it
  SortedPoints& operator=(const SortedPoints&) = delete;

  const kernels::PointsView&
  view() const
  {
    return view_;
  }

  /** \brief Factors of a term's values, on the side of the point and of its neighbour:
   * weight / D, or its root on both sides. */
  float*
  left(std::size_t term)
  {
    return left_.data() + term * stride_;
  }

  float*
  right(std::size_t term)
  {
    return arrays_.data() + (view_.features_end + term) * stride_;
  }

private:
  std::size_t stride_;
  std::vector<float> arrays_; // see PointsView
  std::vector<float> left_;   // of the terms
  std::vector<const float*> left_arrays_;
  std::vector<kernels::TermView> terms_;
  kernels::PointsView view_;
};

} // namespace pcl_semantic
