// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "clique_term.h"

namespace pcl_semantic {

/** \brief The robust P^n potential with its variables y_c, eqs. (7)-(10).
 *
 * Of eq. (11) a member hears of label l what all labels but l say, sum over y != l of
 * k_c^y Q_c(y); up to a constant that is minus k_c^l Q_c(l), one column a clique. */
class RobustTerm : public CliqueTerm {
public:
  RobustTerm(CliquePotential&& potential, bool self_interaction,
             const PaddedColumns& costs);

  double update(const PaddedColumns& marginals) override;
  void addMessages(const PaddedColumns& marginals, Eigen::Index begin, Eigen::Index end,
                   PaddedColumns& messages) const override;
  double freeEnergy(const PaddedColumns& marginals) const override;

  const PaddedColumns*
  cliqueMarginals() const override
  {
    return &marginals_;
  }

private:
  void setCosts(Eigen::Index c, const PaddedColumns& costs);
  void hear();
  void sumMembers(Eigen::Index c, const PaddedColumns& marginals, double* sums) const;
  void addCosts(Eigen::Index c, const double* sums, const float* heard, double share,
                double* costs) const;
  float updateClique(Eigen::Index c, const PaddedColumns& marginals);
  void speak(Eigen::Index c);

  bool self_interaction_;
  Eigen::Index labels_;
  PaddedColumns costs_;     // psi_c(y), the free label last if there is one
  PaddedColumns marginals_; // Q(y_c), as the costs
  PaddedColumns messages_;  // sum over d of k_cd Q_d; zero between updates
  PaddedColumns said_;      // k_c^l Q_c(l), what members hear
};

} // namespace pcl_semantic
