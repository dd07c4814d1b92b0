// SPDX-License-Identifier: BSD-3-Clause

// A CRF as matrices and lists, and its energy directly from eqs. (3) and (5)-(9) of the
// paper in double precision: the reference for the engine. Exact results for small
// graphs: sums over all labellings.

#pragma once

#include <pcl_semantic/crf/crf_model.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcl_semantic {

struct PlainCliques {
  CliquePotential::Type type = CliquePotential::Type::robust;
  std::vector<std::vector<std::int32_t>> members;
  Eigen::MatrixXf weights = Eigen::MatrixXf::Ones(1, 1); // one or L x one or C
  bool free_label = true;
  float truncation = 0.3f;
  std::vector<Eigen::MatrixXf> kernels;

  bool
  isRobust() const
  {
    return type == CliquePotential::Type::robust;
  }

  /** k_c^l */
  double
  weight(int l, std::size_t c) const
  {
    return double(
        weights(weights.rows() > 1 ? l : 0, weights.cols() > 1 ? Eigen::Index(c) : 0));
  }
};

struct PlainCrf {
  Eigen::MatrixXf unary;
  std::vector<Eigen::MatrixXf> kernels;
  Eigen::MatrixXf compatibility; // empty = Potts
  bool self_interaction = false;
  bool start_from_cliques = false;
  std::vector<PlainCliques> cliques;

  int
  labels() const
  {
    return int(unary.rows());
  }

  int
  variables() const
  {
    return int(unary.cols());
  }

  /** The number of labels of y_c: L, or L + 1 with the free label last. */
  int
  cliqueLabels(const PlainCliques& cliques_) const
  {
    return labels() + (cliques_.free_label ? 1 : 0);
  }
};

/** A kernel given as a matrix, weights included; it need not be symmetric. */
class MatrixKernel : public PairwiseKernel {
public:
  explicit MatrixKernel(Eigen::MatrixXf matrix) : matrix_(std::move(matrix)) {}

  Eigen::Index
  size() const override
  {
    return matrix_.rows();
  }

  float
  diagonal(Eigen::Index i) const override
  {
    return matrix_(i, i);
  }

  void
  addProduct(const Eigen::Ref<const Eigen::MatrixXf>& values,
             Eigen::Ref<Eigen::MatrixXf> result) const override
  {
    for (Eigen::Index i = 0; i < size(); ++i)
      for (Eigen::Index j = 0; j < size(); ++j)
        if (j != i)
          result.col(i) += matrix_(i, j) * values.col(j);
  }

private:
  Eigen::MatrixXf matrix_;
};

/** The same CRF for the engine. */
inline CrfModel
makeModel(const PlainCrf& crf)
{
  CrfModel model;
  model.unary = crf.unary;
  for (const Eigen::MatrixXf& kernel : crf.kernels)
    model.kernels.push_back(std::make_shared<MatrixKernel>(kernel));
  if (crf.compatibility.size() > 0)
    model.compatibility = LabelCompatibility(crf.compatibility);
  model.self_interaction = crf.self_interaction;
  model.start_from_cliques = crf.start_from_cliques;
  for (const PlainCliques& cliques : crf.cliques) {
    CliquePotential potential;
    potential.type = cliques.type;
    potential.cliques =
        std::make_shared<CliqueSet>(cliques.members, std::size_t(crf.variables()));
    potential.weights = cliques.weights;
    potential.free_label = cliques.free_label;
    potential.truncation = cliques.truncation;
    for (const Eigen::MatrixXf& kernel : cliques.kernels)
      potential.kernels.push_back(std::make_shared<MatrixKernel>(kernel));
    model.cliques.push_back(potential);
  }
  return model;
}

/** mu(l, k) */
inline double
plainCompatibility(const PlainCrf& crf, int l, int k)
{
  return crf.compatibility.size() > 0 ? double(crf.compatibility(l, k))
                                      : double(l != k);
}

/** sum over m of k^(m)_ij, weights included */
inline double
plainKernel(const std::vector<Eigen::MatrixXf>& kernels, int i, int j)
{
  double sum = 0.0;
  for (const Eigen::MatrixXf& kernel : kernels)
    sum += double(kernel(i, j));
  return sum;
}

/** psi_c(y): a label, or the free one (y = L) at gamma_max = q |c| max_l k_c^l. */
inline double
plainCliqueUnary(const PlainCrf& crf, const PlainCliques& cliques, std::size_t c, int y)
{
  const auto& members = cliques.members[c];
  const int labels = crf.labels();
  if (y == labels) {
    double largest = 0.0;
    for (int l = 0; l < labels; ++l)
      largest = std::max(largest, cliques.weight(l, c));
    return double(cliques.truncation) * double(members.size()) * largest;
  }
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(labels);
  for (const std::int32_t i : members)
    mean += crf.unary.col(i).cast<double>() / double(members.size());
  return mean(y) - mean.minCoeff();
}

/** psi_ci(y, l) */
inline double
plainMemberCost(const PlainCrf& crf, const PlainCliques& cliques, std::size_t c, int y,
                int l)
{
  return y == crf.labels() || y == l ? 0.0 : cliques.weight(y, c);
}

/** psi_cd(y, z) without k_cd: the free label is compatible with everything. */
inline double
plainCliqueCompatibility(const PlainCrf& crf, int y, int z)
{
  return y < crf.labels() && z < crf.labels() && y != z ? 1.0 : 0.0;
}

/** P^n Potts: max_l k_c^l, minus k_c^l if all members take l. */
inline double
plainPnPotts(const PlainCrf& crf, const PlainCliques& cliques, std::size_t c,
             const std::vector<int>& x)
{
  double cost = 0.0;
  for (int l = 0; l < crf.labels(); ++l)
    cost = std::max(cost, cliques.weight(l, c));
  const auto& members = cliques.members[c];
  const int first = x[std::size_t(members[0])];
  for (const std::int32_t i : members)
    if (x[std::size_t(i)] != first)
      return cost;
  return cost - cliques.weight(first, c);
}

/** E(x, y); y of all robust potentials, concatenated. */
inline double
plainEnergy(const PlainCrf& crf, const std::vector<int>& x, const std::vector<int>& y)
{
  double sum = 0.0;
  for (int i = 0; i < crf.variables(); ++i) {
    sum += double(crf.unary(x[std::size_t(i)], i));
    for (int j = 0; j < i; ++j)
      sum += plainKernel(crf.kernels, i, j) *
             plainCompatibility(crf, x[std::size_t(i)], x[std::size_t(j)]);
  }
  std::size_t first = 0;
  for (const PlainCliques& cliques : crf.cliques) {
    for (std::size_t c = 0; c < cliques.members.size(); ++c) {
      if (!cliques.isRobust()) {
        sum += plainPnPotts(crf, cliques, c, x);
        continue;
      }
      const int label = y[first + c];
      sum += plainCliqueUnary(crf, cliques, c, label);
      for (const std::int32_t i : cliques.members[c])
        sum += plainMemberCost(crf, cliques, c, label, x[std::size_t(i)]);
      for (std::size_t d = 0; d < c; ++d)
        sum += plainKernel(cliques.kernels, int(c), int(d)) *
               plainCliqueCompatibility(crf, label, y[first + d]);
    }
    first += cliques.isRobust() ? cliques.members.size() : 0;
  }
  return sum;
}

/** Calls visit(x, y) for all labellings of the variables and of all robust cliques. */
template <typename Visit>
void
forEachLabelling(const PlainCrf& crf, Visit&& visit)
{
  std::vector<int> limits(std::size_t(crf.variables()), crf.labels());
  for (const PlainCliques& cliques : crf.cliques)
    if (cliques.isRobust())
      limits.insert(limits.end(), cliques.members.size(), crf.cliqueLabels(cliques));
  std::vector<int> all(limits.size(), 0);
  for (bool more = true; more;) {
    visit(std::vector<int>(all.begin(), all.begin() + crf.variables()),
          std::vector<int>(all.begin() + crf.variables(), all.end()));
    more = false;
    for (std::size_t i = 0; i < all.size() && !more; ++i) {
      all[i] = (all[i] + 1) % limits[i];
      more = all[i] != 0;
    }
  }
}

/** P(x_i = l), P ~ exp(-E). */
inline Eigen::MatrixXd
exactMarginals(const PlainCrf& crf)
{
  Eigen::MatrixXd marginals = Eigen::MatrixXd::Zero(crf.labels(), crf.variables());
  forEachLabelling(crf, [&](const std::vector<int>& x, const std::vector<int>& y) {
    const double weight = std::exp(-plainEnergy(crf, x, y));
    for (int i = 0; i < crf.variables(); ++i)
      marginals(x[std::size_t(i)], i) += weight;
  });
  return marginals / marginals.col(0).sum();
}

/** Sum over x, y of Q(x, y) (E(x, y) + log Q(x, y)), Q the product of its marginals;
 * those of potentials without y are ignored. */
inline double
enumeratedFreeEnergy(const PlainCrf& crf, const Eigen::MatrixXd& q,
                     const std::vector<Eigen::MatrixXd>& q_cliques)
{
  double sum = 0.0;
  forEachLabelling(crf, [&](const std::vector<int>& x, const std::vector<int>& y) {
    double probability = 1.0;
    for (int i = 0; i < crf.variables(); ++i)
      probability *= q(x[std::size_t(i)], i);
    std::size_t next = 0;
    for (std::size_t p = 0; p < crf.cliques.size(); ++p)
      for (std::size_t c = 0;
           crf.cliques[p].isRobust() && c < crf.cliques[p].members.size(); ++c)
        probability *= q_cliques[p](y[next++], Eigen::Index(c));
    if (probability > 0.0)
      sum += probability * (plainEnergy(crf, x, y) + std::log(probability));
  });
  return sum;
}

} // namespace pcl_semantic
