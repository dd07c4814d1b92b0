// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "clique_term.h"

#include <pcl_semantic/crf/mean_field.h>

#include <vector>

namespace pcl_semantic {

/** \brief What MeanField does, on padded columns: an update has every clique hear its
 * members, gathers the messages of the kernels, then finishes variable after variable
 * while its columns are in the fast cache. */
class MeanField::Engine {
public:
  Engine(CrfModel&& model, const Eigen::MatrixXf* initial);

  double update();
  double freeEnergy() const;

  const PaddedColumns&
  marginals() const
  {
    return marginals_;
  }

  /** \brief Null where there are none. */
  const PaddedColumns* cliqueMarginals(std::size_t potential) const;

private:
  void setUp(const Eigen::MatrixXf& unary);
  void setUpPairs(const CrfModel& model);
  void start(const Eigen::MatrixXf& initial);
  double finish(Eigen::Index begin, Eigen::Index end);

  std::vector<std::shared_ptr<const PairwiseKernel>> kernels_;
  LabelCompatibility compatibility_;
  PaddedColumns costs_;               // psi_i(l) less their minimum over l
  double offset_ = 0.0;               // the sum of the minima
  PaddedColumns marginals_;           // Q(x)
  PaddedColumns messages_;            // zero between updates
  PaddedColumns mixing_;              // mu(l, k), column k; empty = Potts
  std::vector<float> self_responses_; // sum of K_ii; empty = none are to be added
  std::vector<std::unique_ptr<CliqueTerm>> terms_;
};

} // namespace pcl_semantic
