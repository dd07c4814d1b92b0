// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/crf/pairwise_kernel.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief mu(l, l'), the cost of labels l and l' at two linked variables, eq. (5) of
 * the paper. */
class LabelCompatibility {
public:
  /** \brief Potts: mu(l, l') = 1 if l != l', else 0, for any number of labels. */
  LabelCompatibility() = default;

  /** \brief Takes any costs.
   * \param[in] costs L x L; a negative cost attracts
   * \throws InvalidParameterException unless \a costs is square and not empty, and its
   * values are within +-1e9 */
  explicit LabelCompatibility(Eigen::MatrixXf costs);

  /** \brief Whether the costs are Potts, also if they were given as a matrix. */
  bool
  isPotts() const
  {
    return is_potts_;
  }

  /** \brief L; 0 = any number. */
  Eigen::Index
  labels() const
  {
    return costs_.rows();
  }

  /** \brief mu(l, k), labels counted from 0. */
  float
  cost(Eigen::Index l, Eigen::Index k) const
  {
    return costs_.size() > 0 ? costs_(l, k) : float(l != k);
  }

private:
  Eigen::MatrixXf costs_; // empty = Potts for any number of labels
  bool is_potts_ = true;
};

struct IndexRange {
  const std::int32_t* first;
  const std::int32_t* last;

  const std::int32_t*
  begin() const
  {
    return first;
  }

  const std::int32_t*
  end() const
  {
    return last;
  }

  std::size_t
  size() const
  {
    return std::size_t(last - first);
  }
};

/** \brief Lists of indices in one array: list r is indices[starts[r]] up to
 * indices[starts[r + 1]]. */
struct IndexLists {
  std::vector<std::size_t> starts{0};
  std::vector<std::int32_t> indices;

  std::size_t
  size() const
  {
    return starts.size() - 1;
  }

  IndexRange
  operator[](std::size_t row) const
  {
    return {indices.data() + starts[row], indices.data() + starts[row + 1]};
  }
};

/** \brief C cliques over N variables: the members of each clique, and the cliques of
 * each variable. Cliques may overlap and need not cover every variable. */
class CliqueSet {
public:
  CliqueSet() = default;

  /** \param[in] cliques the members of each, counted from 0, for example pcl::Indices
   * \param[in] variables N, up to 2^31 - 1
   * \throws InvalidParameterException that names the clique, if it is empty, has a
   * member outside 0..N-1 or a member twice */
  CliqueSet(const std::vector<std::vector<std::int32_t>>& cliques,
            std::size_t variables);

  /** \brief C, the number of cliques. */
  std::size_t
  size() const
  {
    return members_.size();
  }

  /** \brief N, the number of variables. */
  std::size_t
  variables() const
  {
    return cliques_.size();
  }

  /** \brief The variables of every clique, in the order of the input. */
  const IndexLists&
  members() const
  {
    return members_;
  }

  /** \brief The cliques of every variable, in ascending order. */
  const IndexLists&
  cliques() const
  {
    return cliques_;
  }

private:
  IndexLists members_;
  IndexLists cliques_;
};

/** \brief Cost of cliques whose members disagree, eqs. (7)-(9) of the paper.
 *
 * *P^n Potts* (Kohli, Kumar and Torr 2007; inference as in Vineet, Warrell and Torr
 * 2014): a clique whose members all take l gains k_c^l over one whose members disagree,
 * psi_c(x_c) = max_l k_c^l - (k_c^l if all members take l, else 0).
 *
 * *Robust P^n*: a clique has a variable y_c that takes a label or the free label,
 * psi_c(x_c) = min over y_c of psi_c(y_c) + sum over i in c of psi_ci(y_c, x_i) with
 * psi_ci(l, x_i) = k_c^l where x_i != l; psi_ci(free, .) = 0 and psi_c(free) =
 * gamma_max(c) = q |c| max_l k_c^l. Thus a clique tolerates at least a fraction q of
 * members that disagree before it takes the free label. psi_c(l) is the mean unary cost
 * of the members, shifted so that its minimum over l is 0. */
struct CliquePotential {
  enum class Type { pn_potts, robust };

  Type type = Type::robust;
  std::shared_ptr<const CliqueSet> cliques;

  /** \brief k_c^l >= 0: L x C, or L x 1, 1 x C or 1 x 1 if all cliques, labels or both
   * share it. */
  Eigen::MatrixXf weights = Eigen::MatrixXf::Ones(1, 1);

  // The rest applies only to the robust potential; P^n Potts has no y_c.

  /** \brief y_c may take the free label. Without it the penalty is not truncated, as in
   * the paper's text. */
  bool free_label = true;

  float truncation = 0.3f; ///< q, in (0, 1]

  /** \brief Kernels over the C cliques, Potts: y_c and y_d cost k_cd if both take
   * labels and these differ; the free label is compatible with everything. */
  std::vector<std::shared_ptr<const PairwiseKernel>> kernels;

  float
  weight(Eigen::Index l, Eigen::Index c) const
  {
    return weights(weights.rows() == 1 ? 0 : l, weights.cols() == 1 ? 0 : c);
  }

  float
  largestWeight(Eigen::Index c) const
  {
    return weights.col(weights.cols() == 1 ? 0 : c).maxCoeff();
  }

  /** \brief gamma_max(c), the cost of the free label. */
  double
  freeCost(Eigen::Index c) const
  {
    return double(truncation) * double(cliques->members()[std::size_t(c)].size()) *
           double(largestWeight(c));
  }

  /** \throws InvalidParameterException if a matrix or kernel is missing, its size is
   * not that of L = \a labels, C cliques and N = \a variables, a value is not finite or
   * out of range, or kernels of P^n Potts would be ignored */
  void validate(Eigen::Index labels, Eigen::Index variables) const;
};

/** \brief A CRF over N variables and L labels, eqs. (3) and (9) of the paper: unary
 * costs, pairwise kernels and cliques. Kernels and cliques are optional. */
struct CrfModel {
  /** \brief Costs -log p, L x N, eq. (4); L is 1 to 255. */
  Eigen::MatrixXf unary;

  /** \brief The cost of two variables is the sum of the kernels times the
   * compatibility. */
  std::vector<std::shared_ptr<const PairwiseKernel>> kernels;

  LabelCompatibility compatibility;

  /** \brief Every variable receives its own message through every kernel (K_ii, also
   * between cliques), as in densecrf and PCL; eqs. (10)-(11) sum over j != i only. */
  bool self_interaction = false;

  std::vector<CliquePotential> cliques;

  /** \brief Inference starts with Q(x_i) ~ exp(-psi_i) and the messages of the cliques,
   * so the kernels use them in the first update. If false, it starts without, as in
   * the paper. */
  bool start_from_cliques = false;

  /** \throws InvalidParameterException if a unary cost is not finite, L is not 1 to
   * 255, a kernel is missing or is not over N variables, the compatibility is not over
   * L labels, or as CliquePotential::validate() */
  void validate() const;
};

} // namespace pcl_semantic
