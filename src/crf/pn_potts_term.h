// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "clique_term.h"

#include <vector>

namespace pcl_semantic {

/** \brief The P^n Potts potential (Vineet, Warrell and Torr 2014): a member i hears
 * k_c^l prod over the other members j of Q_j(l).
 *
 * Design and paper speak of logarithms; kernels/column_products.h says why double
 * precision does as well without. */
class PnPottsTerm : public CliqueTerm {
public:
  PnPottsTerm(CliquePotential&& potential, const PaddedColumns& marginals);

  double update(const PaddedColumns& marginals) override;
  void addMessages(const PaddedColumns& marginals, Eigen::Index begin, Eigen::Index end,
                   PaddedColumns& messages) const override;
  double freeEnergy(const PaddedColumns& marginals) const override;

private:
  double*
  product(Eigen::Index c)
  {
    return products_.data() + c * stride_;
  }

  void multiplyMembers(Eigen::Index c, const PaddedColumns& marginals);

  Eigen::Index labels_;
  Eigen::Index stride_;
  std::vector<double> products_; // k_c^l times those of kernels/column_products.h
};

} // namespace pcl_semantic
