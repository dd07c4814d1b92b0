// SPDX-License-Identifier: BSD-3-Clause
#include "robust_term.h"

#include "kernels/column_sums.h"
#include "kernels/soft_max.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pcl_semantic {

namespace {

constexpr std::size_t most_labels = 256; // with the free one

} // namespace

RobustTerm::RobustTerm(CliquePotential&& potential, bool self_interaction,
                       const PaddedColumns& costs)
    : CliqueTerm(std::move(potential), costs.rows()),
      self_interaction_(self_interaction), labels_(costs.rows())
{
  const auto count = Eigen::Index(potential_.cliques->size());
  const Eigen::Index rows = labels_ + (potential_.free_label ? 1 : 0);
  costs_ = PaddedColumns(rows, count);
  marginals_ = PaddedColumns(rows, count);
  messages_ = PaddedColumns(rows, count);
  said_ = PaddedColumns(labels_, count);
  marginals_.setZero();
  messages_.setZero();
  said_.setZero();
#pragma omp parallel for schedule(dynamic, 8) if (count > 8)
  for (Eigen::Index c = 0; c < count; ++c)
    setCosts(c, costs);
  softMax(costs_.column(0), messages_.column(0), marginals_.column(0),
          std::size_t(count), std::size_t(costs_.stride()));
  if (!potential_.hears_members)
    for (Eigen::Index c = 0; c < count; ++c)
      speak(c);
}

void
RobustTerm::setCosts(Eigen::Index c, const PaddedColumns& costs)
{
  std::array<float, most_labels> values;
  if (potential_.unary.size() > 0) {
    std::copy_n(potential_.unary.col(c).data(), labels_, values.data());
  }
  else {
    std::array<double, most_labels> sums;
    sumMembers(c, costs, sums.data());
    const double least = *std::min_element(sums.data(), sums.data() + labels_);
    const auto size = double(potential_.cliques->members()[std::size_t(c)].size());
    for (std::size_t l = 0; l < std::size_t(labels_); ++l)
      values[l] = float((sums[l] - least) / size);
  }
  if (potential_.free_label)
    values[std::size_t(labels_)] = float(potential_.freeCost(c));
  costs_.setColumn(c, values.data(), kPaddingCost);
}

void
RobustTerm::sumMembers(Eigen::Index c, const PaddedColumns& marginals,
                       double* sums) const
{
  const IndexLists& members = potential_.cliques->members();
  const std::size_t begin = members.starts[std::size_t(c)];
  columnSums().sum(members.indices.data() + begin,
                   members.starts[std::size_t(c) + 1] - begin,
                   members.indices.size() - begin, marginals.column(0),
                   std::size_t(marginals.stride()), sums);
}

void
RobustTerm::hear()
{
  for (const auto& kernel : potential_.kernels) {
    kernel->addProduct(marginals_.view(), messages_.view());
    for (Eigen::Index c = 0; c < marginals_.columns(); ++c)
      if (self_interaction_)
        messages_.view().col(c) += kernel->diagonal(c) * marginals_.view().col(c);
  }
}

// Adds the mean costs of the labels of y_c: those that the members pay, from the sums
// of their marginals, and a share of those between cliques, from what is heard of the
// others.
void
RobustTerm::addCosts(Eigen::Index c, const double* sums, const float* heard,
                     double share, double* costs) const
{
  const auto size = double(potential_.cliques->members()[std::size_t(c)].size());
  const float* const weight = weights(c);
  double all = 0.0;
  for (Eigen::Index l = 0; l < labels_; ++l)
    all += double(heard[l]);
  for (Eigen::Index l = 0; l < labels_; ++l)
    costs[l] += double(weight[l]) * (size - sums[l]) + share * (all - double(heard[l]));
}

// Eq. (10). The costs of a large clique are large, and their differences count: they
// are taken in double precision until the least is 0.
float
RobustTerm::updateClique(Eigen::Index c, const PaddedColumns& marginals)
{
  const Eigen::Index rows = marginals_.rows();
  alignas(64) std::array<double, most_labels> sums, costs;
  sumMembers(c, marginals, sums.data());
  std::copy_n(costs_.column(c), rows, costs.data());
  addCosts(c, sums.data(), messages_.column(c), 1.0, costs.data());
  const double least = *std::min_element(costs.data(), costs.data() + rows);
  alignas(64) std::array<float, most_labels> shifted;
  for (std::size_t l = 0; l < std::size_t(rows); ++l)
    shifted[l] = float(std::min(costs[l] - least, double(kPaddingCost)));
  std::fill(shifted.begin() + rows, shifted.begin() + marginals_.stride(),
            kPaddingCost);
  std::fill_n(messages_.column(c), messages_.stride(), 0.0f); // they are in the costs
  const float change =
      softMax(shifted.data(), messages_.column(c), marginals_.column(c), 1,
              std::size_t(marginals_.stride()));
  speak(c);
  return change;
}

void
RobustTerm::speak(Eigen::Index c)
{
  const float* const q = marginals_.column(c);
  const float* const weight = weights(c);
  float* const said = said_.column(c);
  if (!potential_.members_hear_map) {
    for (Eigen::Index l = 0; l < labels_; ++l)
      said[l] = weight[l] * q[l];
    return;
  }
  const Eigen::Index map = std::max_element(q, q + marginals_.rows()) - q;
  std::fill_n(said, labels_, 0.0f);
  if (map < labels_) // the free label says nothing
    said[map] = weight[map];
}

double
RobustTerm::update(const PaddedColumns& marginals)
{
  if (!potential_.hears_members)
    return 0.0;
  hear();
  float change = 0.0f;
  const Eigen::Index count = marginals_.columns();
#pragma omp parallel for schedule(dynamic, 8) reduction(max : change) if (count > 8)
  for (Eigen::Index c = 0; c < count; ++c)
    change = std::max(change, updateClique(c, marginals));
  return double(change);
}

void
RobustTerm::addMessages(const PaddedColumns&, Eigen::Index begin, Eigen::Index end,
                        PaddedColumns& messages) const
{
  const IndexLists& cliques = potential_.cliques->cliques();
  columnSums().add(cliques.starts.data() + begin, cliques.indices.data(),
                   std::size_t(end - begin), said_.column(0),
                   std::size_t(said_.stride()), messages.column(begin));
}

double
RobustTerm::freeEnergy(const PaddedColumns& marginals) const
{
  PaddedColumns heard(marginals_.rows(), marginals_.columns());
  heard.setZero();
  for (const auto& kernel : potential_.kernels)
    kernel->addProduct(marginals_.view(), heard.view());
  return orderedSum(marginals_.columns(), 64, [&](Eigen::Index c) {
    alignas(64) std::array<double, most_labels> sums, costs;
    sumMembers(c, marginals, sums.data());
    std::copy_n(costs_.column(c), marginals_.rows(), costs.data());
    addCosts(c, sums.data(), heard.column(c), 0.5, costs.data()); // each pair once
    double sum = 0.0;
    for (Eigen::Index l = 0; l < marginals_.rows(); ++l) {
      const double q = marginals_.column(c)[l];
      if (q > 0.0)
        sum += q * (costs[std::size_t(l)] + std::log(q));
    }
    return sum;
  });
}

} // namespace pcl_semantic
