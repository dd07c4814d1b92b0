// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/crf/clique_potential.h>
#include <pcl_semantic/crf/label_compatibility.h>
#include <pcl_semantic/crf/pairwise_kernel.h>

#include <memory>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A CRF over N variables and L labels, eqs. (3) and (9) of the paper: unary
 * costs, pairwise kernels and cliques. Each of the last two may be missing. */
struct CrfModel {
  /** \brief Costs -log p, L x N, eq. (4); L is 1 to 255. */
  Eigen::MatrixXf unary;

  /** \brief Their sum, times the compatibility, is what two variables pay. */
  std::vector<std::shared_ptr<const PairwiseKernel>> kernels;

  LabelCompatibility compatibility;

  /** \brief Every variable hears itself through every kernel (K_ii, between cliques
   * too), as in densecrf and PCL, instead of j != i only as eqs. (10)-(11) say. It is
   * part of the updates, not of any energy. */
  bool self_interaction = false;

  std::vector<CliquePotential> cliques;

  /** \throws InvalidParameterException if sizes differ, a unary cost is not finite, L
   * is not 1 to 255, a kernel is missing, or as CliquePotential::validate() */
  void validate() const;
};

} // namespace pcl_semantic
