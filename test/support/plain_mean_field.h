// SPDX-License-Identifier: BSD-3-Clause

// Mean-field updates directly from eqs. (10) and (11) of the paper, in double
// precision.

#pragma once

#include "support/brute_force_crf.h"
#include "support/plain_crf.h"

#include <cmath>
#include <vector>

namespace pcl_semantic {

class PlainMeanField {
public:
  explicit PlainMeanField(PlainCrf crf)
      : crf_(std::move(crf)), q(softMax(-crf_.unary.cast<double>()))
  {
    for (const PlainCliques& cliques : crf_.cliques) {
      cliques_of_.emplace_back(std::size_t(crf_.variables()));
      for (std::size_t c = 0; c < cliques.members.size(); ++c)
        for (const std::int32_t i : cliques.members[c])
          cliques_of_.back()[std::size_t(i)].push_back(c);
      Eigen::MatrixXd costs(crf_.cliqueLabels(cliques), cliques.members.size());
      for (Eigen::Index c = 0; c < costs.cols(); ++c)
        for (int y = 0; y < costs.rows(); ++y)
          costs(y, c) = plainCliqueUnary(crf_, cliques, std::size_t(c), y);
      q_cliques.push_back(softMax(-costs));
    }
    if (crf_.start_from_cliques)
      startFromCliques();
  }

  /** First every y_c, then every x_i. */
  void
  update()
  {
    for (std::size_t p = 0; p < crf_.cliques.size(); ++p)
      if (crf_.cliques[p].isRobust())
        updateCliques(crf_.cliques[p], q_cliques[p]);
    Eigen::MatrixXd costs(q.rows(), q.cols());
    for (int i = 0; i < q.cols(); ++i)
      for (int l = 0; l < q.rows(); ++l)
        costs(l, i) = cost(i, l);
    q = softMax(-costs);
  }

private:
  PlainCrf crf_;
  // by potential and variable
  std::vector<std::vector<std::vector<std::size_t>>> cliques_of_;

public:
  Eigen::MatrixXd q;                      // Q(x_i = l)
  std::vector<Eigen::MatrixXd> q_cliques; // Q(y_c = l) of every potential

private:
  // An update of a model without pairwise kernels.
  void
  startFromCliques()
  {
    PlainCrf alone = crf_;
    alone.start_from_cliques = false;
    alone.kernels.clear();
    PlainMeanField start(alone);
    start.update();
    q = start.q;
    q_cliques = start.q_cliques;
  }

  // Eq. (10)
  void
  updateCliques(const PlainCliques& cliques, Eigen::MatrixXd& q_y) const
  {
    Eigen::MatrixXd costs(q_y.rows(), q_y.cols());
    for (int c = 0; c < q_y.cols(); ++c)
      for (int y = 0; y < q_y.rows(); ++y) {
        double sum = plainCliqueUnary(crf_, cliques, std::size_t(c), y);
        for (int d = 0; d < q_y.cols(); ++d)
          for (int z = 0; z < q_y.rows(); ++z)
            if (d != c || crf_.self_interaction)
              sum += q_y(z, d) * plainKernel(cliques.kernels, c, d) *
                     plainCliqueCompatibility(crf_, y, z);
        for (const std::int32_t i : cliques.members[std::size_t(c)])
          for (int l = 0; l < q.rows(); ++l)
            sum += q(l, i) * plainMemberCost(crf_, cliques, std::size_t(c), y, l);
        costs(y, c) = sum;
      }
    q_y = softMax(-costs);
  }

  // Eq. (11): the mean cost of label l for variable i
  double
  cost(int i, int l) const
  {
    double sum = double(crf_.unary(l, i));
    for (int j = 0; j < q.cols() && !crf_.kernels.empty(); ++j)
      for (int k = 0; k < q.rows(); ++k)
        if (j != i || crf_.self_interaction)
          sum += q(k, j) * plainKernel(crf_.kernels, i, j) *
                 plainCompatibility(crf_, l, k);
    for (std::size_t p = 0; p < crf_.cliques.size(); ++p)
      for (const std::size_t c : cliques_of_[p][std::size_t(i)])
        sum += crf_.cliques[p].isRobust() ? robustCost(p, c, l)
                                          : pnPottsCost(crf_.cliques[p], c, i, l);
    return sum;
  }

  double
  robustCost(std::size_t p, std::size_t c, int l) const
  {
    const PlainCliques& cliques = crf_.cliques[p];
    const Eigen::VectorXd q_y = q_cliques[p].col(Eigen::Index(c));
    double sum = 0.0;
    for (int y = 0; y < q_y.size(); ++y)
      sum += q_y(y) * plainMemberCost(crf_, cliques, c, y, l);
    return sum;
  }

  // Mean cost of x_i = l, over the cases that all others take l and that they do not.
  double
  pnPottsCost(const PlainCliques& cliques, std::size_t c, int i, int l) const
  {
    double largest = 0.0, product = 1.0;
    for (int k = 0; k < q.rows(); ++k)
      largest = std::max(largest, cliques.weight(k, c));
    for (const std::int32_t j : cliques.members[c])
      if (j != i)
        product *= q(l, j);
    return product * (largest - cliques.weight(l, c)) + (1.0 - product) * largest;
  }
};

} // namespace pcl_semantic
