/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/crf/pairwise_kernel.h>

#include <memory>
#include <vector>

namespace pcl_semantic {

/** \brief A CRF over N variables and L labels: unary costs and Potts pairwise kernels,
 * eq. (3) of the paper. */
struct CrfModel {
  Eigen::MatrixXf unary; ///< L x N costs -log p, eq. (4)
  std::vector<std::shared_ptr<const PairwiseKernel>> kernels;
};

/** \brief Mean-field inference, eq. (11) without cliques: all variables at once,
 * Q_i(l) ~ exp(-psi_i(l) + sum over j != i of k_ij Q_j(l)). */
class MeanField {
public:
  /** \brief Starts at Q_i(l) ~ exp(-psi_i(l)).
   * \throws InvalidParameterException if sizes differ or a cost is not finite */
  explicit MeanField(CrfModel model);

  /** \brief One update of all variables. */
  void update();

  /** \brief Q, L x N, columns sum to one. */
  const Eigen::MatrixXf&
  marginals() const
  {
    return marginals_;
  }

private:
  CrfModel model_;
  Eigen::MatrixXf marginals_;
  Eigen::MatrixXf messages_;
};

} // namespace pcl_semantic
