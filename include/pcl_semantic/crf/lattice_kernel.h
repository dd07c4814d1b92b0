/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/crf/permutohedral_lattice.h>

namespace pcl_semantic {

/** \brief One Gaussian over any features, w exp(-|f_i - f_j|^2 / 2), on a permutohedral
 * lattice: for features of many dimensions, and for wide kernels. */
class LatticeKernel : public PairwiseKernel {
public:
  /** \param[in] features d x N, divided by their deviations; d is 1 to 16
   * \param[in] weight w, 0 or more
   * \param[in] normalization with D_i as the lattice itself responds to ones
   * \param[in] blur forward makes K a little asymmetric, in exchange for speed
   * \param[in] tier instructions to use; for tests
   * \throws InvalidParameterException at a weight that is negative or not finite, or as
   * PermutohedralLattice */
  explicit LatticeKernel(const Eigen::Ref<const Eigen::MatrixXf>& features,
                         float weight = 1.0f,
                         Normalization normalization = Normalization::symmetric,
                         LatticeBlur blur = LatticeBlur::symmetric,
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

  void addProduct(const Eigen::Ref<const Eigen::MatrixXf>& values,
                  Eigen::Ref<Eigen::MatrixXf> result,
                  const VariableMask& active) const override;

  const PermutohedralLattice&
  lattice() const
  {
    return lattice_;
  }

  /** \brief Bytes that the kernel keeps. */
  std::size_t memory() const;

private:
  PermutohedralLattice lattice_;
  LatticeBlur blur_;
  PermutohedralLattice::Scales scales_;
};

} // namespace pcl_semantic
