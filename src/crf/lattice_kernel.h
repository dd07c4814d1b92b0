// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "permutohedral_lattice.h"

#include <pcl_semantic/crf/pairwise_kernel.h>

#include <mutex>

namespace pcl_semantic {

/** \brief A weighted Gaussian over any features, w exp(-|f_i - f_j|^2 / 2), on a
 * permutohedral lattice: for high-dimensional features and wide kernels.
 *
 * Averages the blur from the first direction to the last (as in the paper) and the
 * reverse order, which is symmetric and closer to the Gaussian. Results depend neither
 * on the number of threads nor on the SIMD tier. Concurrent calls on one kernel are
 * serialised. */
class LatticeKernel : public PairwiseKernel {
public:
  /** \param[in] features d x N, divided by their deviations; d is 1 to 16
   * \param[in] weight w, 0 or more
   * \param[in] normalization with D_i as the lattice's response to ones
   * \param[in] tier instructions to use; for tests
   * \param[in] lows see PermutohedralLattice
   * \throws InvalidParameterException if the weight is negative or not finite, or as
   * PermutohedralLattice */
  explicit LatticeKernel(const Eigen::Ref<const Eigen::MatrixXf>& features,
                         float weight = 1.0f,
                         Normalization normalization = Normalization::symmetric,
                         SimdTier tier = simdTier(), const Eigen::VectorXf& lows = {});

  Eigen::Index
  size() const override
  {
    return Eigen::Index(lattice_.points);
  }

  float
  diagonal(Eigen::Index i) const override
  {
    return diagonal_[i];
  }

  void addProduct(const Eigen::Ref<const Eigen::MatrixXf>& values,
                  Eigen::Ref<Eigen::MatrixXf> result) const override;

  const PermutohedralLattice&
  lattice() const
  {
    return lattice_;
  }

private:
  const PermutohedralLattice lattice_;
  SimdTier tier_;
  Eigen::ArrayXf splat_scale_; // of values before they are summed
  Eigen::ArrayXf slice_scale_; // of sums
  Eigen::ArrayXf diagonal_;    // of a point's own value, which is subtracted

  // Rows on the lattice, reused between products because allocation costs more than
  // filling.
  mutable std::mutex mutex_;
  mutable AlignedArray<float> rows_;
};

} // namespace pcl_semantic
