/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

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
   * \param[in] widening factor of the variance of positions */
  SortedPoints(const Eigen::Matrix3Xf& positions,
               const std::vector<std::int32_t>& order,
               const std::vector<GaussianTerm>& terms, float squared_radius,
               float widening);
  SortedPoints(const SortedPoints&) = delete; // views point into it
  SortedPoints& operator=(const SortedPoints&) = delete;

  const kernels::PointsView&
  view() const
  {
    return view_;
  }

  /** \brief Arrays of scratch that sumTerms needs. */
  std::size_t
  scratchArrays() const
  {
    return 4 + features_.size();
  }

  /** \brief Factors of a term's values, on the side of the point and of its neighbour:
   * weight / D, or its root on both sides. */
  std::vector<float>&
  left(std::size_t term)
  {
    return left_[term];
  }

  std::vector<float>&
  right(std::size_t term)
  {
    return right_[term];
  }

  /** \brief The factors of all terms. */
  std::vector<const float*> leftArrays() const;
  std::vector<const float*> rightArrays() const;

private:
  std::vector<float> positions_[3];
  std::vector<std::vector<float>> features_; // of all terms
  std::vector<const float*> feature_arrays_;
  std::vector<kernels::TermView> terms_;
  std::vector<std::vector<float>> left_, right_; // of the terms
  kernels::PointsView view_;
};

} // namespace pcl_semantic
