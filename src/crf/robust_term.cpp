/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "robust_term.h"

#include "kernels/soft_max.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pcl_semantic {

namespace {

using LabelSums = std::array<double, 256>; // labels and the free label

} // namespace

RobustTerm::RobustTerm(const CliquePotential& potential, bool self_interaction,
                       const PaddedColumns& costs)
    : potential_(potential), self_interaction_(self_interaction), labels_(costs.rows())
{
  const auto count = Eigen::Index(potential_.cliques->size());
  const Eigen::Index rows = labels_ + (potential_.free_label ? 1 : 0);
  costs_ = PaddedColumns(rows, count, kPaddingCost);
  marginals_ = PaddedColumns(rows, count);
  messages_ = PaddedColumns(rows, count);
  said_ = PaddedColumns(labels_, count);
  setCosts(costs);
  softMax(costs_.column(0), messages_.column(0), marginals_.column(0),
          std::size_t(count), std::size_t(costs_.stride()));
}

void
RobustTerm::setCosts(const PaddedColumns& costs)
{
#pragma omp parallel for schedule(dynamic, 16)
  for (Eigen::Index c = 0; c < costs_.columns(); ++c) {
    float* const cost = costs_.column(c);
    if (potential_.unary.size() > 0) {
      std::copy_n(potential_.unary.col(c).data(), labels_, cost);
    }
    else {
      LabelSums sums;
      sumMembers(c, costs, sums.data());
      const double least = *std::min_element(sums.data(), sums.data() + labels_);
      const auto size = double(potential_.cliques->members()[std::size_t(c)].size());
      for (Eigen::Index l = 0; l < labels_; ++l)
        cost[l] = float((sums[std::size_t(l)] - least) / size);
    }
    if (potential_.free_label)
      cost[labels_] = float(potential_.freeCost(c));
  }
}

void
RobustTerm::sumMembers(Eigen::Index c, const PaddedColumns& marginals,
                       double* sums) const
{
  std::fill_n(sums, labels_, 0.0);
  for (const std::int32_t i : potential_.cliques->members()[std::size_t(c)])
    for (Eigen::Index l = 0; l < labels_; ++l)
      sums[l] += double(marginals.column(i)[l]);
}

void
RobustTerm::addKernelMessages(const VariableMask& active)
{
  for (const auto& kernel : potential_.kernels) {
    kernel->addProduct(marginals_.view(), messages_.view(), active);
    if (self_interaction_)
      for (Eigen::Index c = 0; c < marginals_.columns(); ++c)
        messages_.view().col(c) += kernel->diagonal(c) * marginals_.view().col(c);
  }
}

// Eq. (10), from the messages of the other cliques. Costs are differences of large sums
// of large cliques: they are taken in double precision until the smallest is 0.
float
RobustTerm::updateClique(Eigen::Index c, const PaddedColumns& marginals)
{
  LabelSums values;
  sumMembers(c, marginals, values.data());
  float* const message = messages_.column(c);
  double heard = 0.0;
  for (Eigen::Index l = 0; l < labels_; ++l)
    heard += double(message[l]);
  const auto size = double(potential_.cliques->members()[std::size_t(c)].size());
  for (Eigen::Index l = 0; l < labels_; ++l)
    values[std::size_t(l)] =
        -double(costs_.column(c)[l]) - (heard - double(message[l])) -
        double(potential_.weight(l, c)) * (size - values[std::size_t(l)]);
  if (potential_.free_label)
    values[std::size_t(labels_)] = -double(costs_.column(c)[labels_]);
  const double largest =
      *std::max_element(values.data(), values.data() + costs_.rows());
  std::array<float, 256> costs;
  costs.fill(kPaddingCost);
  for (Eigen::Index l = 0; l < costs_.rows(); ++l)
    costs[std::size_t(l)] = float(std::min(largest - values[std::size_t(l)], 1e30));
  std::fill_n(message, messages_.stride(), 0.0f);
  const float change = softMax(costs.data(), message, marginals_.column(c), 1,
                               std::size_t(marginals_.stride()));
  speak(c);
  return change;
}

void
RobustTerm::speak(Eigen::Index c)
{
  const float* const q = marginals_.column(c);
  const Eigen::Index map = std::max_element(q, q + marginals_.rows()) - q;
  for (Eigen::Index l = 0; l < labels_; ++l)
    said_.column(c)[l] = potential_.weight(l, c) *
                         (potential_.members_hear_map ? float(l == map) : q[l]);
}

double
RobustTerm::update(const PaddedColumns& marginals)
{
  addKernelMessages({});
  float change = 0.0f;
#pragma omp parallel for schedule(dynamic, 16) reduction(max : change)
  for (Eigen::Index c = 0; c < marginals_.columns(); ++c)
    change = std::max(change, updateClique(c, marginals));
  return double(change);
}

double
RobustTerm::updateSequentially(const PaddedColumns& marginals)
{
  VariableMask active(potential_.cliques->size(), 0);
  float change = 0.0f;
  for (Eigen::Index c = 0; c < marginals_.columns(); ++c) {
    active[std::size_t(c)] = 1;
    messages_.setZero();
    addKernelMessages(active);
    change = std::max(change, updateClique(c, marginals));
    active[std::size_t(c)] = 0;
  }
  messages_.setZero();
  return double(change);
}

void
RobustTerm::addMessages(const PaddedColumns&, Eigen::Index begin, Eigen::Index end,
                        PaddedColumns& messages) const
{
  for (Eigen::Index i = begin; i < end; ++i)
    for (const std::int32_t c : potential_.cliques->cliques()[std::size_t(i)])
      for (Eigen::Index l = 0; l < said_.stride(); ++l)
        messages.column(i)[l] += said_.column(c)[l];
}

double
RobustTerm::freeEnergy(const PaddedColumns& marginals) const
{
  PaddedColumns heard(marginals_.rows(), marginals_.columns());
  for (const auto& kernel : potential_.kernels)
    kernel->addProduct(marginals_.view(), heard.view(), {});
  double sum = 0.0;
  for (Eigen::Index c = 0; c < marginals_.columns(); ++c) {
    const float* const q = marginals_.column(c);
    const float* const message = heard.column(c);
    const auto size = double(potential_.cliques->members()[std::size_t(c)].size());
    LabelSums members;
    sumMembers(c, marginals, members.data());
    double all = 0.0;
    for (Eigen::Index l = 0; l < labels_; ++l)
      all += double(message[l]);
    for (Eigen::Index l = 0; l < marginals_.rows(); ++l) {
      double cost = double(costs_.column(c)[l]);
      if (l < labels_)
        cost += double(potential_.weight(l, c)) * (size - members[std::size_t(l)]) +
                0.5 * (all - double(message[l]));
      if (q[l] > 0.0f)
        sum += double(q[l]) * (cost + std::log(double(q[l])));
    }
  }
  return sum;
}

} // namespace pcl_semantic
