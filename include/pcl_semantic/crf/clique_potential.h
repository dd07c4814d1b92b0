// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/crf/clique_set.h>
#include <pcl_semantic/crf/pairwise_kernel.h>

#include <memory>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief What the members of cliques pay for disagreeing, eqs. (7)-(9) of the paper.
 *
 * *P^n Potts* (Kohli, Kumar and Torr 2007; inference as Vineet, Warrell and Torr 2014):
 * a clique whose members all take l gains k_c^l over one whose members do not agree,
 * psi_c(x_c) = max_l k_c^l - (k_c^l if all members take l, else 0).
 *
 * *Robust P^n*: a clique has a variable y_c of its own that takes a label or the free
 * label, psi_c(x_c) = min over y_c of psi_c(y_c) + sum over i in c of psi_ci(y_c, x_i)
 * with psi_ci(l, x_i) = k_c^l where x_i != l; psi_ci(free, .) = 0 and psi_c(free) =
 * gamma_max(c) = q |c| max_l k_c^l: every label bears a share q of members that
 * disagree, at least, before the clique lets go. */
struct CliquePotential {
  enum class Type { pn_potts, robust };

  Type type = Type::robust;
  std::shared_ptr<const CliqueSet> cliques;

  /** \brief k_c^l, 0 or more: L x C, or L x 1, 1 x C or 1 x 1 where all cliques, labels
   * or both have the same. */
  Eigen::MatrixXf weights = Eigen::MatrixXf::Ones(1, 1);

  // The rest is for the robust potential only; P^n Potts has no y_c.

  /** \brief y_c may take the free label; without it the penalty is not truncated, which
   * is the paper's text. */
  bool free_label = true;

  float truncation = 0.3f; ///< q, more than 0 and up to 1

  /** \brief psi_c(l), L x C; empty = mean unary cost of the members, shifted so that
   * its minimum over l is 0. */
  Eigen::MatrixXf unary;

  /** \brief Kernels over the C cliques, Potts: y_c and y_d pay k_cd if both take labels
   * and these differ; the free label is compatible with everything. */
  std::vector<std::shared_ptr<const PairwiseKernel>> kernels;

  /** \brief Members hear the label of largest Q(y_c) alone (the paper's algorithm text)
   * instead of the distribution (its eq. (11)). Of equal ones the first is taken. */
  bool members_hear_map = false;

  /** \brief Without it the cliques are known: Q(y_c) stays exp(-psi_c(y_c)),
   * normalised, and members hear it. For costs that were learned from all that is known
   * of a clique, its members' opinion included: eq. (10) would have it count again, and
   * so often as there are members. */
  bool hears_members = true;

  /** \brief k_c^l. */
  float
  weight(Eigen::Index l, Eigen::Index c) const
  {
    return weights(weights.rows() == 1 ? 0 : l, weights.cols() == 1 ? 0 : c);
  }

  /** \brief max_l k_c^l. */
  float
  largestWeight(Eigen::Index c) const
  {
    return weights.col(weights.cols() == 1 ? 0 : c).maxCoeff();
  }

  /** \brief gamma_max(c), what the free label costs. */
  double
  freeCost(Eigen::Index c) const
  {
    return double(truncation) * double(cliques->members()[std::size_t(c)].size()) *
           double(largestWeight(c));
  }

  /** \throws InvalidParameterException if something is missing, has another size than
   * L = \a labels and N = \a variables want, is not finite or out of its range, or
   * would be ignored (a unary cost or kernels of P^n Potts) */
  void validate(Eigen::Index labels, Eigen::Index variables) const;
};

} // namespace pcl_semantic
