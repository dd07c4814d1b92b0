// SPDX-License-Identifier: BSD-3-Clause

// Exact answers for small graphs: sums over all labellings.

#pragma once

#include "support/plain_crf.h"

#include <cmath>
#include <vector>

namespace pcl_semantic {

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
 * those of the potentials without y are not looked at. */
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
