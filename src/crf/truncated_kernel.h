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

/** \brief Sum of Gaussian terms over points in space, each normalised by itself, as
 * exact sums over all pairs within a radius.
 *
 * What is cut off beyond a short radius would make a kernel narrower: the deviation of
 * positions of a normalised one is widened in turn (widening()). That is good for
 * points closer than a deviation, as voxels are; sparser ones, and kernels without
 * normalisation, want a radius of 3 (doc/crf.md has the errors).
 * Set-up finds the neighbours of every point and keeps their weights, summed over the
 * terms, as bfloat16 (a relative error of up to 2^-8 each). A product goes over all
 * pairs (i, j) and (j, i). Points of different positions may come in any order: the
 * result has the same bits. */
class TruncatedKernel : public PairwiseKernel {
public:
  /** \param[in] positions 3 x N
   * \param[in] terms all of one position deviation; their features have N columns
   * \param[in] radius of the sums, in deviations of positions
   * \throws InvalidParameterException at a deviation or radius that is not positive,
   * deviations of positions that differ, a negative weight, features of another size,
   * values that are not finite, positions too far apart (canHold()), or more pairs than
   * memory is meant to hold (2^31) */
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

  /** \brief Factor of the variance of positions for a radius in deviations: 2 at 2
   * deviations, 1.15 at 2.5, next to 1 beyond 3; 1 without normalisation. */
  static float widening(float radius, Normalization normalization);

  /** \brief Whether positions lie near enough to each other: 2^19 deviations along each
   * axis. */
  static bool canHold(const Eigen::Matrix3Xf& positions, float deviation);

  /** \brief An order of points in which a kernel over them works fastest: numbers of
   * the columns of \a positions. \param[in] deviation of positions */
  static std::vector<std::int32_t> fastestOrder(const Eigen::Matrix3Xf& positions,
                                                float radius, float deviation);

private:
  struct Chunk;

  void sumTerms(const PointRows& rows, SortedPoints& points,
                const std::vector<GaussianTerm>& terms, Normalization normalization);

  void normalize(SortedPoints& points, const std::vector<GaussianTerm>& terms,
                 std::size_t point, const float* sums, Normalization normalization);

  void makeWeights(const SortedPoints& points);

  std::vector<std::int32_t> order_; // empty = the points came sorted
  std::vector<Chunk> chunks_;
  Eigen::VectorXf diagonal_;
};

} // namespace pcl_semantic
