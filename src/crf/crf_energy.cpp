// SPDX-License-Identifier: BSD-3-Clause
#include "crf_energy.h"
#include "core/fail.h"

#include <algorithm>

namespace pcl_semantic {

namespace {

using Labels = std::vector<int>;

std::size_t
cliqueVariables(const CrfModel& model)
{
  std::size_t count = 0;
  for (const CliquePotential& potential : model.cliques)
    if (potential.type == CliquePotential::Type::robust)
      count += potential.cliques->size();
  return count;
}

void
validate(const CrfModel& model, const Labels& x)
{
  model.validate();
  if (!model.compatibility.isSymmetric())
    badParameter("an energy needs a symmetric label compatibility");
  if (Eigen::Index(x.size()) != model.unary.cols())
    badParameter(x.size(), " labels, expected ", model.unary.cols());
  for (std::size_t i = 0; i < x.size(); ++i)
    if (x[i] < 0 || x[i] >= model.unary.rows())
      badParameter("the label of variable ", i, " is ", x[i],
                   ", expected 0 to less than ", model.unary.rows());
}

// Sum over pairs of k_ij mu(x_i, x_j); labels beyond L pay nothing.
template <typename Cost>
double
pairCosts(const std::vector<std::shared_ptr<const PairwiseKernel>>& kernels,
          const int* labels, Eigen::Index rows, Eigen::Index columns, Cost&& cost)
{
  if (kernels.empty())
    return 0.0;
  Eigen::MatrixXf taken = Eigen::MatrixXf::Zero(rows, columns);
  Eigen::MatrixXf messages = taken;
  for (Eigen::Index i = 0; i < columns; ++i)
    if (labels[i] < rows)
      taken(labels[i], i) = 1.0f;
  for (const auto& kernel : kernels)
    kernel->addProduct(taken, messages);
  double sum = 0.0;
  for (Eigen::Index i = 0; i < columns; ++i)
    for (Eigen::Index k = 0; k < rows && labels[i] < rows; ++k)
      sum += 0.5 * double(cost(labels[i], k)) * double(messages(k, i));
  return sum;
}

double
meanUnary(const CrfModel& model, IndexRange members, Eigen::Index l)
{
  double sum = 0.0;
  for (const std::int32_t i : members)
    sum += double(model.unary(l, i));
  return sum / double(members.size());
}

// psi_c(l) + sum over i in c of psi_ci(l, x_i), for all y_c, the free label last.
std::vector<double>
robustCosts(const CrfModel& model, const CliquePotential& potential, std::size_t c,
            const Labels& x)
{
  const IndexRange members = potential.cliques->members()[c];
  const Eigen::Index labels = model.unary.rows(), column = Eigen::Index(c);
  std::vector<double> costs(static_cast<std::size_t>(labels));
  for (Eigen::Index l = 0; l < labels; ++l)
    costs[std::size_t(l)] = potential.unary.size() > 0
                                ? double(potential.unary(l, column))
                                : meanUnary(model, members, l);
  if (potential.unary.size() == 0) {
    const double least = *std::min_element(costs.begin(), costs.end());
    for (double& cost : costs)
      cost -= least;
  }
  for (Eigen::Index l = 0; l < labels; ++l)
    for (const std::int32_t i : members)
      if (x[std::size_t(i)] != l)
        costs[std::size_t(l)] += double(potential.weight(l, column));
  if (potential.free_label)
    costs.push_back(potential.freeCost(column));
  return costs;
}

double
pnPottsCost(const CliquePotential& potential, std::size_t c, const Labels& x)
{
  const IndexRange members = potential.cliques->members()[c];
  const int label = x[std::size_t(*members.begin())];
  double cost = double(potential.largestWeight(Eigen::Index(c)));
  if (std::all_of(members.begin(), members.end(),
                  [&](std::int32_t i) { return x[std::size_t(i)] == label; }))
    cost -= double(potential.weight(label, Eigen::Index(c)));
  return cost;
}

} // namespace

double
energy(const CrfModel& model, const Labels& x, const Labels& y)
{
  validate(model, x);
  if (y.size() != cliqueVariables(model))
    badParameter(y.size(), " labels of cliques, expected ", cliqueVariables(model));
  double sum = pairCosts(
      model.kernels, x.data(), model.unary.rows(), model.unary.cols(),
      [&](Eigen::Index l, Eigen::Index k) { return model.compatibility.cost(l, k); });
  for (std::size_t i = 0; i < x.size(); ++i)
    sum += double(model.unary(x[i], Eigen::Index(i)));
  const int* label = y.data();
  for (const CliquePotential& potential : model.cliques) {
    const std::size_t count = potential.cliques->size();
    if (potential.type == CliquePotential::Type::pn_potts) {
      for (std::size_t c = 0; c < count; ++c)
        sum += pnPottsCost(potential, c, x);
      continue;
    }
    for (std::size_t c = 0; c < count; ++c) {
      const std::vector<double> costs = robustCosts(model, potential, c, x);
      if (label[c] < 0 || std::size_t(label[c]) >= costs.size())
        badParameter("the label of clique ", c, " is ", label[c],
                     ", expected 0 to less than ", costs.size());
      sum += costs[std::size_t(label[c])];
    }
    sum += pairCosts(potential.kernels, label, model.unary.rows(), Eigen::Index(count),
                     [](Eigen::Index l, Eigen::Index k) { return l != k; });
    label += count;
  }
  return sum;
}

} // namespace pcl_semantic
