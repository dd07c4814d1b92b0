/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "pn_potts_term.h"

#include <array>

namespace pcl_semantic {

PnPottsTerm::PnPottsTerm(CliquePotential&& potential, const PaddedColumns& marginals)
    : CliqueTerm(std::move(potential)), labels_(marginals.rows()),
      stride_(marginals.stride()),
      products_(std::size_t(stride_) * potential_.cliques->size())
{}

double*
PnPottsTerm::product(Eigen::Index c)
{
  return products_.data() + c * stride_;
}

void
PnPottsTerm::multiplyMembers(Eigen::Index c, const PaddedColumns& marginals)
{
  std::array<double, 256> products;
  std::array<int, 256> zeros;
  products.fill(1.0);
  zeros.fill(0);
  for (const std::int32_t i : potential_.cliques->members()[std::size_t(c)]) {
    const float* const q = marginals.column(i);
    for (std::size_t l = 0; l < std::size_t(stride_); ++l) {
      const double next = products[l] * double(q[l] > 0.0f ? q[l] : 1.0f);
      products[l] = next < 1e-200 ? 0.0 : next;
      zeros[l] += q[l] > 0.0f ? 0 : 1;
    }
  }
  for (Eigen::Index l = 0; l < labels_; ++l) {
    const double sign =
        double(zeros[std::size_t(l)] == 0) - double(zeros[std::size_t(l)] == 1);
    product(c)[l] = sign * double(potential_.weight(l, c)) * products[std::size_t(l)];
  }
}

double
PnPottsTerm::update(const PaddedColumns& marginals)
{
  const std::size_t count = potential_.cliques->size();
#pragma omp parallel for schedule(dynamic, 8) if (count > 8)
  for (std::size_t c = 0; c < count; ++c)
    multiplyMembers(Eigen::Index(c), marginals);
  return 0.0;
}

double
PnPottsTerm::updateSequentially(const PaddedColumns& marginals)
{
  return update(marginals);
}

void
PnPottsTerm::variableChanged(Eigen::Index i, const PaddedColumns& marginals)
{
  for (const std::int32_t c : potential_.cliques->cliques()[std::size_t(i)])
    multiplyMembers(c, marginals);
}

void
PnPottsTerm::addMessages(const PaddedColumns& marginals, Eigen::Index begin,
                         Eigen::Index end, PaddedColumns& messages) const
{
  for (Eigen::Index i = begin; i < end; ++i)
    for (const std::int32_t c : potential_.cliques->cliques()[std::size_t(i)]) {
      const double* const products = products_.data() + c * stride_;
      const float* const q = marginals.column(i);
      float* const message = messages.column(i);
      for (Eigen::Index l = 0; l < stride_; ++l) {
        const double without = q[l] > 0.0f ? products[l] / double(q[l]) : -products[l];
        message[l] += float(without > 0.0 ? without : 0.0);
      }
    }
}

double
PnPottsTerm::freeEnergy(const PaddedColumns& marginals) const
{
  const auto count = Eigen::Index(potential_.cliques->size());
  return orderedSum(count, 64, [&](Eigen::Index c) {
    auto cost = double(potential_.largestWeight(c));
    for (Eigen::Index l = 0; l < labels_; ++l) {
      auto product = double(potential_.weight(l, c));
      for (const std::int32_t i : potential_.cliques->members()[std::size_t(c)])
        product *= double(marginals.column(i)[l]);
      cost -= product;
    }
    return cost;
  });
}

} // namespace pcl_semantic
