/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include "clique_term.h"

#include <vector>

namespace pcl_semantic {

/** \brief The P^n Potts potential (Vineet, Warrell and Torr 2014): a member hears
 * k_c^l prod over the other members j of Q_j(l).
 *
 * The product without i is the whole one over Q_i(l). Whole ones are kept in double
 * precision, whose range does what logarithms would: where one is too small for it, so
 * is the product without i, which is at most 1e45 times as large. Zeros are counted
 * instead of multiplied. */
class PnPottsTerm : public CliqueTerm {
public:
  PnPottsTerm(const CliquePotential& potential, Eigen::Index labels);

  double update(const PaddedColumns& marginals) override;
  double updateSequentially(const PaddedColumns& marginals) override;
  void variableChanged(Eigen::Index i, const PaddedColumns& marginals) override;
  void addMessages(const PaddedColumns& marginals, Eigen::Index begin, Eigen::Index end,
                   PaddedColumns& messages) const override;
  double freeEnergy(const PaddedColumns& marginals) const override;

private:
  void multiplyMembers(Eigen::Index c, const PaddedColumns& marginals);

  CliquePotential potential_;
  Eigen::Index labels_;
  // L x C: the product over the members; its negative without the member whose Q is
  // zero, if there is one; 0 if there are more.
  std::vector<double> products_;
};

} // namespace pcl_semantic
