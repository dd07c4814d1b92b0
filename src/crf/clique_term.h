// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "padded_columns.h"

#include <pcl_semantic/crf/crf_model.h>

#include <memory>

namespace pcl_semantic {

/** \brief One clique potential in mean-field inference: the messages between the
 * variables x and its cliques. */
class CliqueTerm {
public:
  CliqueTerm(CliquePotential&& potential, Eigen::Index labels);
  virtual ~CliqueTerm() = default;

  /** \brief Updates all cliques at once from Q(x). */
  virtual void update(const PaddedColumns& marginals) = 0;

  /** \brief Adds the messages of the cliques to the variables begin..end-1: the
   * negative mean cost of each label, up to a constant per variable. */
  virtual void addMessages(const PaddedColumns& marginals, Eigen::Index begin,
                           Eigen::Index end, PaddedColumns& messages) const = 0;

  /** \brief Q(y), or null if the potential has no y. */
  virtual const PaddedColumns*
  cliqueMarginals() const
  {
    return nullptr;
  }

protected:
  /** \brief k_c^l of all labels. */
  const float*
  weights(Eigen::Index c) const
  {
    return weights_.column(weights_.columns() == 1 ? 0 : c);
  }

  CliquePotential potential_;

private:
  PaddedColumns weights_; // one column per clique, or one for all
};

/** \param[in] costs psi_i(l) up to a constant of the variable */
std::unique_ptr<CliqueTerm> makeCliqueTerm(CliquePotential&& potential,
                                           bool self_interaction,
                                           const PaddedColumns& costs);

} // namespace pcl_semantic
