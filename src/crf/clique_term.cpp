// SPDX-License-Identifier: BSD-3-Clause
#include "clique_term.h"

#include "pn_potts_term.h"
#include "robust_term.h"

namespace pcl_semantic {

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
