/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include "clique_term.h"

#include <vector>

namespace pcl_semantic {

/** \brief The robust P^n potential with its variables y_c, eqs. (7)-(10). */
class RobustTerm : public CliqueTerm {
public:
  RobustTerm(const CliquePotential& potential, bool self_interaction,
             const PaddedColumns& costs);

  double update(const PaddedColumns& marginals) override;
  double updateSequentially(const PaddedColumns& marginals) override;
  void addMessages(const PaddedColumns& marginals, Eigen::Index begin, Eigen::Index end,
                   PaddedColumns& messages) const override;
  double freeEnergy(const PaddedColumns& marginals) const override;

  const PaddedColumns*
  cliqueMarginals() const override
  {
    return &marginals_;
  }

private:
  void setCosts(const PaddedColumns& costs);
  void addKernelMessages(const VariableMask& active);
  void sumMembers(Eigen::Index c, const PaddedColumns& marginals, double* sums) const;
  float updateClique(Eigen::Index c, const PaddedColumns& marginals);
  void speak(Eigen::Index c);

  CliquePotential potential_;
  bool self_interaction_;
  Eigen::Index labels_;
  PaddedColumns costs_;     // psi_c(y), the free label last if there is one
  PaddedColumns marginals_; // Q(y_c), as the costs
  PaddedColumns messages_;  // sum over d of k_cd Q_d; zero between updates
  PaddedColumns said_;      // k_c^l Q_c(l), what members hear, L x C
};

} // namespace pcl_semantic
