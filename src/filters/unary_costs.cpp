// SPDX-License-Identifier: BSD-3-Clause
#include "unary_costs.h"

#include <algorithm>

namespace pcl_semantic {

Eigen::MatrixXf
unaryCosts(const Eigen::MatrixXf& measured, const std::vector<std::int32_t>& columns)
{
  constexpr float smallest = 1e-6f;
  constexpr std::size_t block = 64; // logarithms are quicker many at a time
  Eigen::MatrixXf costs(measured.rows(), Eigen::Index(columns.size()));
#pragma omp parallel for schedule(static)
  for (std::size_t begin = 0; begin < columns.size(); begin += block) {
    const std::size_t end = std::min(columns.size(), begin + block);
    for (std::size_t k = begin; k < end; ++k) {
      const auto column = measured.col(columns[k]);
      double sum = 0.0; // in this order, wherever the column lies
      for (const float value : column)
        sum += double(value);
      if (sum > 0.0)
        costs.col(Eigen::Index(k)) = (column.cast<double>() / sum).cast<float>();
      else
        costs.col(Eigen::Index(k)).setOnes(); // no cost
    }
    Eigen::Map<Eigen::ArrayXf> values(costs.data() + Eigen::Index(begin) * costs.rows(),
                                      Eigen::Index(end - begin) * costs.rows());
    values = -values.max(smallest).log();
  }
  return costs;
}

} // namespace pcl_semantic
