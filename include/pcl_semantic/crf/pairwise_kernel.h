// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Normalisation of a Gaussian kernel K, with D_i = sum over all j of k_ij, i
 * included: D^-1/2 K D^-1/2, D^-1 K, or none. */
enum class Normalization { symmetric, one_sided, none };

/** \brief A normalised and weighted kernel matrix K over N variables, represented by
 * its product with values: the pairwise term of the CRF, eq. (6). */
class PairwiseKernel {
public:
  virtual ~PairwiseKernel() = default;

  /** \brief N, the number of variables. */
  virtual Eigen::Index size() const = 0;

  /** \brief K_ii, the weight of a variable's own value. */
  virtual float diagonal(Eigen::Index i) const = 0;

  /** \brief Adds K without its diagonal: result(:, i) += sum over j != i of K_ij
   * values(:, j).
   *
   * Fastest if columns start at multiples of 64 bytes and have a multiple of 16 rows.
   * The result does not depend on that.
   * \param[in] values any number of rows x N
   * \param[in,out] result as values */
  virtual void addProduct(const Eigen::Ref<const Eigen::MatrixXf>& values,
                          Eigen::Ref<Eigen::MatrixXf> result) const = 0;
};

} // namespace pcl_semantic
