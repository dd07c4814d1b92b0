/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include "clique_term.h"

#include <vector>

namespace pcl_semantic {

/** \brief The P^n Potts potential (Vineet, Warrell and Torr 2014): a member i hears
 * k_c^l prod over the other members j of Q_j(l).
 *
 * The product without i is the whole one over Q_i(l). Zeros are counted instead of
 * multiplied. Whole products are in double precision, whose range does what logarithms
 * would: marginals are 0 or more than 1e-27 (kernels/soft_max.h), so where the whole
 * one is too small for it (1e-200), the product without i is nothing too. */
class PnPottsTerm : public CliqueTerm {
public:
  PnPottsTerm(CliquePotential&& potential, const PaddedColumns& marginals);

  double update(const PaddedColumns& marginals) override;
  double updateSequentially(const PaddedColumns& marginals) override;
  void variableChanged(Eigen::Index i, const PaddedColumns& marginals) override;
  void addMessages(const PaddedColumns& marginals, Eigen::Index begin, Eigen::Index end,
                   PaddedColumns& messages) const override;
  double freeEnergy(const PaddedColumns& marginals) const override;

private:
  double* product(Eigen::Index c);
  void multiplyMembers(Eigen::Index c, const PaddedColumns& marginals);

  Eigen::Index labels_;
  Eigen::Index stride_;
  // By clique and label: k_c^l times the product over the members; if one member's Q is
  // zero, minus k_c^l times the product of the others; 0 if more are zero.
  std::vector<double> products_;
};

} // namespace pcl_semantic
