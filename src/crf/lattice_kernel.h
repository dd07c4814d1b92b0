// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "permutohedral_lattice.h"

#include <pcl_semantic/crf/pairwise_kernel.h>

namespace pcl_semantic {

/** \brief A weighted Gaussian over any features, w exp(-|f_i - f_j|^2 / 2), on a
 * permutohedral lattice: for features of many dimensions, and for wide kernels. */
class LatticeKernel : public PairwiseKernel {
public:
  /** \param[in] features d x N, divided by their deviations; d is 1 to 16
   * \param[in] weight w, 0 or more
   * \param[in] normalization with D_i as the lattice itself responds to ones
   * \param[in] tier instructions to use; for tests
   * \throws InvalidParameterException if the weight is negative or not finite, or as
   * PermutohedralLattice */
  explicit LatticeKernel(const Eigen::Ref<const Eigen::MatrixXf>& features,
                         float weight = 1.0f,
                         Normalization normalization = Normalization::symmetric,
                         SimdTier tier = simdTier());

  Eigen::Index
  size() const override
  {
    return lattice_.size();
  }

  float
  diagonal(Eigen::Index i) const override
  {
    return scales_.diagonal[i];
  }

  void
  addProduct(const Eigen::Ref<const Eigen::MatrixXf>& values,
             Eigen::Ref<Eigen::MatrixXf> result) const override
  {
    lattice_.addFiltered(values, scales_, result);
  }

  const PermutohedralLattice&
  lattice() const
  {
    return lattice_;
  }

private:
  PermutohedralLattice lattice_;
  PermutohedralLattice::Scales scales_;
};

} // namespace pcl_semantic
