// SPDX-License-Identifier: BSD-3-Clause
#include "sorted_points.h"

#include <cmath>

namespace pcl_semantic {

namespace {

constexpr std::size_t padding = 16; // the loops read as many values behind the last
constexpr float log2_e = 1.44269504f;

} // namespace

SortedPoints::SortedPoints(const Eigen::Matrix3Xf& positions,
                           const std::vector<std::int32_t>& order,
                           const std::vector<GaussianTerm>& terms, float squared_radius,
                           float variance)
    : stride_(order.size() + padding)
{
  std::size_t arrays = 3;
  for (const GaussianTerm& term : terms) {
    terms_.push_back({int(term.features.rows()), arrays});
    arrays += std::size_t(term.features.rows());
  }
  arrays_.resize((arrays + terms.size()) * stride_);
  left_.resize(terms.size() * stride_);
  for (std::size_t m = 0; m < terms.size(); ++m)
    left_arrays_.push_back(left(m));
  view_ = {arrays_.data(),
           stride_,
           arrays,
           squared_radius,
           log2_e / (2.0f * variance),
           terms_.data(),
           int(terms_.size()),
           left_arrays_.data()};
  const auto copyRows = [&](const auto& matrix, std::size_t first, float scale) {
#pragma omp parallel for schedule(static)
    for (std::size_t i = 0; i < order.size(); ++i)
      for (Eigen::Index row = 0; row < matrix.rows(); ++row)
        arrays_[(first + std::size_t(row)) * stride_ + i] =
            scale * matrix(row, order[i]);
  };
  copyRows(positions, 0, 1.0f);
  for (std::size_t m = 0; m < terms.size(); ++m)
    copyRows(terms[m].features, terms_[m].first, std::sqrt(log2_e / 2.0f));
}

} // namespace pcl_semantic
