// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/crf/pairwise_kernel.h>

namespace pcl_semantic {

/** \brief A kernel given as a matrix, for small graphs and for checks: a product costs
 * N^2. */
class MatrixKernel : public PairwiseKernel {
public:
  /** \param[in] matrix K, N x N, weights included. It need not be symmetric (one-sided
   * normalisation is not); energies then take its symmetric part.
   * \throws InvalidParameterException if it is not square or not finite */
  explicit MatrixKernel(Eigen::MatrixXf matrix);

  Eigen::Index
  size() const override
  {
    return matrix_.rows();
  }

  float
  diagonal(Eigen::Index i) const override
  {
    return matrix_(i, i);
  }

  void addProduct(const Eigen::Ref<const Eigen::MatrixXf>& values,
                  Eigen::Ref<Eigen::MatrixXf> result) const override;

  const Eigen::MatrixXf&
  matrix() const
  {
    return matrix_;
  }

private:
  Eigen::MatrixXf matrix_;
};

} // namespace pcl_semantic
