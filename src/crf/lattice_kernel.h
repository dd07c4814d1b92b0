// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "permutohedral_lattice.h"

namespace pcl_semantic {

/** \brief A weighted Gaussian over any features: w exp(-|f_i - f_j|^2 / 2). */
struct LatticeTerm {
  Eigen::MatrixXf features; ///< d x N, divided by their deviations; d is 1 to 16
  float weight = 1.0f;      ///< w, 0 or more
};

/** \brief Sum of Gaussian terms, each normalised by itself, on permutohedral lattices:
 * for features of many dimensions, and for wide kernels. */
class LatticeKernel : public PairwiseKernel {
public:
  /** \param[in] terms over the same points; of all of them in one kernel products are
   * faster than of a kernel each
   * \param[in] normalization with D_i as the lattice itself responds to ones
   * \param[in] blur forward makes K a little asymmetric, in exchange for speed
   * \param[in] tier instructions to use; for tests
   * \throws InvalidParameterException if there is no term, their sizes differ, a weight
   * is negative or not finite, or as PermutohedralLattice */
  explicit LatticeKernel(const std::vector<LatticeTerm>& terms,
                         Normalization normalization = Normalization::symmetric,
                         LatticeBlur blur = LatticeBlur::symmetric,
                         SimdTier tier = simdTier());

  /** \brief Of one term. */
  explicit LatticeKernel(const Eigen::Ref<const Eigen::MatrixXf>& features,
                         float weight = 1.0f,
                         Normalization normalization = Normalization::symmetric,
                         LatticeBlur blur = LatticeBlur::symmetric,
                         SimdTier tier = simdTier())
      : LatticeKernel(std::vector<LatticeTerm>{{features, weight}}, normalization, blur,
                      tier)
  {}

  Eigen::Index
  size() const override
  {
    return diagonal_.size();
  }

  float
  diagonal(Eigen::Index i) const override
  {
    return diagonal_[i];
  }

  void addProduct(const Eigen::Ref<const Eigen::MatrixXf>& values,
                  Eigen::Ref<Eigen::MatrixXf> result) const override;

  /** \brief The lattice of a term. */
  const PermutohedralLattice&
  lattice(std::size_t term = 0) const
  {
    return lattices_[term];
  }

  /** \brief Bytes that the kernel keeps. */
  std::size_t memory() const;

private:
  std::vector<PermutohedralLattice> lattices_;
  std::vector<PermutohedralLattice::Scales> scales_;
  std::vector<PermutohedralLattice::Term> terms_; // of the two above
  LatticeBlur blur_;
  Eigen::ArrayXf diagonal_;
};

} // namespace pcl_semantic
