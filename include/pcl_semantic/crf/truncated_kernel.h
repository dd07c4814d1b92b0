/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/crf/gaussian_term.h>
#include <pcl_semantic/crf/pairwise_kernel.h>

#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief Sum of Gaussian terms, each normalised symmetrically (D^-1/2 K D^-1/2 with
 * D_i = sum over all j, i included), as exact sums over all pairs within a radius.
 *
 * Set-up finds and keeps the neighbours of every point; a product visits each pair
 * once per side, so the result does not depend on the number of threads. */
class TruncatedKernel : public PairwiseKernel {
public:
  /** \param[in] positions 3 x N
   * \param[in] terms their features have N columns
   * \param[in] radius of the sums, in the largest position deviation
   * \throws InvalidParameterException at a deviation or radius that is not positive, a
   * negative weight, features of another size, values that are not finite, or more
   * pairs than memory is meant to hold (2^31) */
  TruncatedKernel(const Eigen::Matrix3Xf& positions,
                  const std::vector<GaussianTerm>& terms, float radius);

  Eigen::Index
  size() const override
  {
    return static_cast<Eigen::Index>(starts_.size()) - 1;
  }

  float
  diagonal(Eigen::Index i) const override
  {
    return diagonal_[i];
  }

  void addProduct(const Eigen::Ref<const Eigen::MatrixXf>& values,
                  Eigen::Ref<Eigen::MatrixXf> result,
                  const VariableMask& active) const override;

  /** \brief Number of ordered pairs within the radius. */
  std::size_t
  pairs() const
  {
    return neighbours_.size();
  }

private:
  void setWeights(const Eigen::Matrix3Xf& positions,
                  const std::vector<GaussianTerm>& terms);

  std::vector<std::size_t> starts_;      // of each point's neighbours, N + 1
  std::vector<std::int32_t> neighbours_; // without the point itself
  std::vector<float> weights_;           // normalised, summed over the terms
  Eigen::VectorXf diagonal_;
};

} // namespace pcl_semantic
