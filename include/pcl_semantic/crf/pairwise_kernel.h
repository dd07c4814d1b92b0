/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/core/abi_check.h>

#include <Eigen/Core>

namespace pcl_semantic {

/** \brief A symmetric kernel matrix K over N variables, known by what it does to
 * values: the pairwise term of the CRF, eq. (6). */
class PairwiseKernel {
public:
  virtual ~PairwiseKernel() = default;

  /** \brief N, the number of variables. */
  virtual Eigen::Index size() const = 0;

  /** \brief result(:, i) += sum over j != i of K_ij values(:, j), weights included.
   * \param[in] values any number of rows x N
   * \param[in,out] result as values */
  virtual void addProduct(const Eigen::MatrixXf& values,
                          Eigen::MatrixXf& result) const = 0;
};

} // namespace pcl_semantic
