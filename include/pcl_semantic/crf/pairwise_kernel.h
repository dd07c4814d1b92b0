// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief How a Gaussian kernel k is normalised, with D_i = sum over all j of k_ij, i
 * included: D^-1/2 K D^-1/2, D^-1 K, or not at all. */
enum class Normalization { symmetric, one_sided, none };

/** \brief A kernel matrix K over N variables, normalised and weighted, known by what it
 * does to values: the pairwise term of the CRF, eq. (6). */
class PairwiseKernel {
public:
  virtual ~PairwiseKernel() = default;

  /** \brief N, the number of variables. */
  virtual Eigen::Index size() const = 0;

  /** \brief K_ii, the weight of a variable's own value. */
  virtual float diagonal(Eigen::Index i) const = 0;

  /** \brief result(:, i) += sum over j != i of K_ij values(:, j).
   *
   * Fastest where columns start at multiples of 64 bytes and have a multiple of 16
   * rows; the result does not depend on that.
   * \param[in] values any number of rows x N
   * \param[in,out] result as values */
  virtual void addProduct(const Eigen::Ref<const Eigen::MatrixXf>& values,
                          Eigen::Ref<Eigen::MatrixXf> result) const = 0;
};

} // namespace pcl_semantic
