// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/crf/gaussian_kernels.h>
#include <pcl_semantic/crf/pairwise_kernel.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace pcl_semantic {

class PointRows;
class SortedPoints;

/** \brief Sum of separately normalised Gaussian terms over points in space: exact sums
 * over all pairs within a radius.
 *
 * A short radius would make a kernel narrower, so the position deviation of a
 * normalised kernel is widened to compensate (widening()). This suits points closer
 * than a deviation, such as voxels. Sparser points, and kernels without normalisation,
 * need a radius of 3 (doc/crf.md lists the errors).
 *
 * Set-up finds the neighbours of every point and stores their weights, summed over the
 * terms, as bfloat16 (relative error up to 2^-8 each). A product visits all pairs (i,
 * j) and (j, i). The result is bit-identical for any order of points with different
 * positions. */
class TruncatedKernel : public PairwiseKernel {
public:
  /** \param[in] positions 3 x N
   * \param[in] terms all with the same position deviation; their features have N
   * columns
   * \param[in] radius of the sums, in deviations of positions
   * \throws InvalidParameterException for a deviation or radius that is not positive,
   * position deviations that differ, a negative weight, features of another size,
   * values that are not finite, positions too far apart (canHold()), or more than 2^31
   * pairs */
  TruncatedKernel(const Eigen::Matrix3Xf& positions,
                  const std::vector<GaussianTerm>& terms, float radius,
                  Normalization normalization = Normalization::symmetric);
  ~TruncatedKernel() override;

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

  /** \brief Factor on the position variance for a radius in deviations: 2 at 2
   * deviations, 1.15 at 2.5, almost 1 beyond 3; 1 without normalisation. */
  static float widening(float radius, Normalization normalization);

  /** \brief Whether the extent of the positions is at most 2^19 deviations along each
   * axis. */
  static bool canHold(const Eigen::Matrix3Xf& positions, float deviation);

  /** \brief The fastest order of points for a kernel: indices of the columns of \a
   * positions.
   * \param[in] deviation of positions */
  static std::vector<std::int32_t> fastestOrder(const Eigen::Matrix3Xf& positions,
                                                float radius, float deviation);

private:
  struct Chunk;

  void sumTerms(const PointRows& rows, SortedPoints& points,
                const std::vector<GaussianTerm>& terms, Normalization normalization);

  void normalize(SortedPoints& points, const std::vector<GaussianTerm>& terms,
                 std::size_t point, const float* sums, Normalization normalization);

  void makeWeights(const SortedPoints& points);

  std::vector<std::int32_t> order_; // empty = the points were already sorted
  std::vector<Chunk> chunks_;
  Eigen::VectorXf diagonal_;
};

} // namespace pcl_semantic
