// SPDX-License-Identifier: BSD-3-Clause
#include "clique_term.h"

#include "kernels/inference_loops.h"

#include <algorithm>
#include <array>
#include <vector>

namespace pcl_semantic {

/** \brief The P^n Potts potential (Vineet, Warrell and Torr 2014): member i receives
 * k_c^l prod over the other members j of Q_j(l).
 *
 * The paper uses logarithms; kernels/inference_loops.h explains why double precision
 * works without. */
class PnPottsTerm : public CliqueTerm {
public:
  PnPottsTerm(CliquePotential&& potential, const PaddedColumns& marginals)
      : CliqueTerm(std::move(potential), marginals.rows()), labels_(marginals.rows()),
        stride_(marginals.stride()),
        products_(std::size_t(stride_) * potential_.cliques->size())
  {}

  void
  update(const PaddedColumns& marginals) override
  {
    const std::size_t count = potential_.cliques->size();
#pragma omp parallel for schedule(dynamic, 8) if (count > 8)
    for (std::size_t c = 0; c < count; ++c)
      multiplyMembers(Eigen::Index(c), marginals);
  }

  void
  addMessages(const PaddedColumns& marginals, Eigen::Index begin, Eigen::Index end,
              PaddedColumns& messages) const override
  {
    const IndexLists& cliques = potential_.cliques->cliques();
    kernels::inferenceLoops().addWithout(
        cliques.starts.data() + begin, cliques.indices.data(), std::size_t(end - begin),
        products_.data(), marginals.column(begin), std::size_t(stride_),
        messages.column(begin));
  }

private:
  double*
  product(Eigen::Index c)
  {
    return products_.data() + c * stride_;
  }

  void
  multiplyMembers(Eigen::Index c, const PaddedColumns& marginals)
  {
    const IndexLists& members = potential_.cliques->members();
    const std::size_t begin = members.starts[std::size_t(c)];
    kernels::inferenceLoops().multiplyColumns(
        members.indices.data() + begin, members.starts[std::size_t(c) + 1] - begin,
        members.indices.size() - begin, marginals.column(0), std::size_t(stride_),
        product(c));
    for (Eigen::Index l = 0; l < stride_; ++l)
      product(c)[l] *= double(weights(c)[l]);
  }

  Eigen::Index labels_;
  Eigen::Index stride_;
  std::vector<double> products_; // k_c^l times the products of multiplyColumns()
};

/** \brief The robust P^n potential with its variables y_c, eqs. (7)-(10).
 *
 * By eq. (11) a member's cost of label l is the sum over y != l of k_c^y Q_c(y). Up to
 * a constant this is -k_c^l Q_c(l), one column per clique. */
class RobustTerm : public CliqueTerm {
public:
  RobustTerm(CliquePotential&& potential, bool self_interaction,
             const PaddedColumns& costs)
      : CliqueTerm(std::move(potential), costs.rows()),
        self_interaction_(self_interaction), labels_(costs.rows())
  {
    const auto count = Eigen::Index(potential_.cliques->size());
    const Eigen::Index rows = labels_ + (potential_.free_label ? 1 : 0);
    costs_ = PaddedColumns(rows, count);
    marginals_ = PaddedColumns(rows, count);
    messages_ = PaddedColumns(rows, count);
    clique_messages_ = PaddedColumns(labels_, count);
    marginals_.setZero();
    messages_.setZero();
    clique_messages_.setZero();
#pragma omp parallel for schedule(dynamic, 8) if (count > 8)
    for (Eigen::Index c = 0; c < count; ++c)
      setCosts(c, costs);
    kernels::inferenceLoops().softMax(costs_.column(0), messages_.column(0),
                                      marginals_.column(0), std::size_t(count),
                                      std::size_t(costs_.stride()));
  }

  void
  update(const PaddedColumns& marginals) override
  {
    passMessages();
    const Eigen::Index count = marginals_.columns();
#pragma omp parallel for schedule(dynamic, 8) if (count > 8)
    for (Eigen::Index c = 0; c < count; ++c)
      updateClique(c, marginals);
  }

  void
  addMessages(const PaddedColumns&, Eigen::Index begin, Eigen::Index end,
              PaddedColumns& messages) const override
  {
    const IndexLists& cliques = potential_.cliques->cliques();
    kernels::inferenceLoops().addColumns(
        cliques.starts.data() + begin, cliques.indices.data(), std::size_t(end - begin),
        clique_messages_.column(0), std::size_t(clique_messages_.stride()),
        messages.column(begin));
  }

  const PaddedColumns*
  cliqueMarginals() const override
  {
    return &marginals_;
  }

private:
  static constexpr std::size_t max_labels = 256; // including the free label

  void
  setCosts(Eigen::Index c, const PaddedColumns& costs)
  {
    std::array<float, max_labels> values;
    std::array<double, max_labels> sums;
    sumMembers(c, costs, sums.data());
    const double least = *std::min_element(sums.data(), sums.data() + labels_);
    const auto size = double(potential_.cliques->members()[std::size_t(c)].size());
    for (std::size_t l = 0; l < std::size_t(labels_); ++l)
      values[l] = float((sums[l] - least) / size);
    if (potential_.free_label)
      values[std::size_t(labels_)] = float(potential_.freeCost(c));
    costs_.setColumn(c, values.data(), kernels::padding_cost);
  }

  void
  passMessages()
  {
    for (const auto& kernel : potential_.kernels) {
      kernel->addProduct(marginals_.view(), messages_.view());
      for (Eigen::Index c = 0; c < marginals_.columns(); ++c)
        if (self_interaction_)
          messages_.view().col(c) += kernel->diagonal(c) * marginals_.view().col(c);
    }
  }

  void
  sumMembers(Eigen::Index c, const PaddedColumns& marginals, double* sums) const
  {
    const IndexLists& members = potential_.cliques->members();
    const std::size_t begin = members.starts[std::size_t(c)];
    kernels::inferenceLoops().sumColumns(
        members.indices.data() + begin, members.starts[std::size_t(c) + 1] - begin,
        members.indices.size() - begin, marginals.column(0),
        std::size_t(marginals.stride()), sums);
  }

  // Adds the mean costs of the labels of y_c: from the members, by the sums of their
  // marginals, and from other cliques, by their messages.
  void
  addCosts(Eigen::Index c, const double* sums, const float* messages,
           double* costs) const
  {
    const auto size = double(potential_.cliques->members()[std::size_t(c)].size());
    const float* const weight = weights(c);
    double all = 0.0;
    for (Eigen::Index l = 0; l < labels_; ++l)
      all += double(messages[l]);
    for (Eigen::Index l = 0; l < labels_; ++l)
      costs[l] += double(weight[l]) * (size - sums[l]) + (all - double(messages[l]));
  }

  // Eq. (10). The costs of a large clique are large and only their differences matter,
  // so they are in double precision until the minimum is 0.
  void
  updateClique(Eigen::Index c, const PaddedColumns& marginals)
  {
    const Eigen::Index rows = marginals_.rows();
    alignas(64) std::array<double, max_labels> sums, costs;
    sumMembers(c, marginals, sums.data());
    std::copy_n(costs_.column(c), rows, costs.data());
    addCosts(c, sums.data(), messages_.column(c), costs.data());
    const double least = *std::min_element(costs.data(), costs.data() + rows);
    alignas(64) std::array<float, max_labels> shifted;
    for (std::size_t l = 0; l < std::size_t(rows); ++l)
      shifted[l] = float(std::min(costs[l] - least, double(kernels::padding_cost)));
    std::fill(shifted.begin() + rows, shifted.begin() + marginals_.stride(),
              kernels::padding_cost);
    std::fill_n(messages_.column(c), messages_.stride(), 0.0f); // consumed by the costs
    kernels::inferenceLoops().softMax(shifted.data(), messages_.column(c),
                                      marginals_.column(c), 1,
                                      std::size_t(marginals_.stride()));
    updateCliqueMessage(c);
  }

  void
  updateCliqueMessage(Eigen::Index c)
  {
    const float* const q = marginals_.column(c);
    const float* const weight = weights(c);
    float* const message = clique_messages_.column(c);
    for (Eigen::Index l = 0; l < labels_; ++l)
      message[l] = weight[l] * q[l];
  }

  bool self_interaction_;
  Eigen::Index labels_;
  PaddedColumns costs_;           // psi_c(y), the free label last if there is one
  PaddedColumns marginals_;       // Q(y_c), as the costs
  PaddedColumns messages_;        // sum over d of k_cd Q_d; zero between updates
  PaddedColumns clique_messages_; // k_c^l Q_c(l), to the members
};

CliqueTerm::CliqueTerm(CliquePotential&& potential, Eigen::Index labels)
    : potential_(std::move(potential)), weights_(labels, potential_.weights.cols())
{
  weights_.setZero();
  for (Eigen::Index c = 0; c < weights_.columns(); ++c)
    for (Eigen::Index l = 0; l < labels; ++l)
      weights_.column(c)[l] = potential_.weight(l, c);
}

std::unique_ptr<CliqueTerm>
makeCliqueTerm(CliquePotential&& potential, bool self_interaction,
               const PaddedColumns& costs)
{
  if (potential.type == CliquePotential::Type::pn_potts)
    return std::make_unique<PnPottsTerm>(std::move(potential), costs);
  return std::make_unique<RobustTerm>(std::move(potential), self_interaction, costs);
}

} // namespace pcl_semantic
