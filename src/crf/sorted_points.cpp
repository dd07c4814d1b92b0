/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "sorted_points.h"

#include <cmath>

namespace pcl_semantic {

namespace {

constexpr std::size_t padding = 16; // the loops read as many values behind the last
constexpr float log2_e = 1.44269504f;

std::vector<const float*>
arraysOf(const std::vector<std::vector<float>>& vectors)
{
  std::vector<const float*> arrays;
  for (const std::vector<float>& vector : vectors)
    arrays.push_back(vector.data());
  return arrays;
}

} // namespace

SortedPoints::SortedPoints(const Eigen::Matrix3Xf& positions,
                           const std::vector<std::int32_t>& order,
                           const std::vector<GaussianTerm>& terms, float squared_radius,
                           float widening)
{
  const auto copyRow = [&](const auto& matrix, Eigen::Index row, float scale) {
    std::vector<float> array(order.size() + padding, 0.0f);
    for (std::size_t i = 0; i < order.size(); ++i)
      array[i] = scale * matrix(row, order[i]);
    return array;
  };
  for (int a = 0; a < 3; ++a) {
    positions_[a] = copyRow(positions, a, 1.0f);
    view_.position[a] = positions_[a].data();
  }
  for (const GaussianTerm& term : terms)
    for (Eigen::Index d = 0; d < term.features.rows(); ++d)
      features_.push_back(copyRow(term.features, d, std::sqrt(log2_e / 2.0f)));
  feature_arrays_ = arraysOf(features_);
  const float* const* next = feature_arrays_.data();
  for (const GaussianTerm& term : terms) {
    const float variance = term.position_deviation * term.position_deviation * widening;
    terms_.push_back({log2_e / (2.0f * variance), next, int(term.features.rows())});
    next += term.features.rows();
  }
  left_.assign(terms.size(), std::vector<float>(order.size() + padding, 0.0f));
  right_ = left_;
  view_.squared_radius = squared_radius;
  view_.terms = terms_.data();
  view_.count = int(terms_.size());
}

std::vector<const float*>
SortedPoints::leftArrays() const
{
  return arraysOf(left_);
}

std::vector<const float*>
SortedPoints::rightArrays() const
{
  return arraysOf(right_);
}

} // namespace pcl_semantic
