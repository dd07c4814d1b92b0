// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"
#include "lattice_structure.h"

#include <pcl_semantic/core/abi_check.h>

#include <Eigen/Core>

#include <memory>
#include <mutex>
#include <vector>

namespace pcl_semantic {

/** \brief The permutohedral lattice of Adams, Baek and Davis (2010): sums with the
 * Gaussian k_ij = exp(-|f_i - f_j|^2 / 2) of N points in time linear in N, near enough.
 *
 * Values are splatted to the vertices of the simplex around their point, blurred with
 * the taps 1/2 1 1/2 along every direction in turn, and sliced where they are asked
 * for. Vertices around no point do not exist: what would pass through them is lost, and
 * what is lost depends on the order of the directions. The mean of the order from the
 * first to the last, as the paper has it, and of the reverse is a symmetric map, and
 * nearer to the Gaussian. The lattice lies the same way around the least features of
 * the points, wherever these are. Results do not depend on the number of threads, nor
 * on the SIMD tier; several threads may use one lattice at a time. */
class PermutohedralLattice {
public:
  /** \param[in] features d x N, divided by their deviations; d is 1 to 16
   * \param[in] tier instructions to use; for tests
   * \throws InvalidParameterException if a feature is not finite, d is not 1 to 16, or
   * features span so many deviations that the keys of vertices (128 bits) cannot tell
   * them apart: not below 50 at d = 16, more at fewer */
  explicit PermutohedralLattice(const Eigen::Ref<const Eigen::MatrixXf>& features,
                                SimdTier tier = simdTier())
      : structure_(buildLattice(features, tier)), tier_(tier)
  {}

  /** \brief N. */
  Eigen::Index
  size() const
  {
    return Eigen::Index(structure_.points);
  }

  /** \brief Features at which a vertex lies: 0 to 1 less than the least of the points.
   */
  Eigen::VectorXd origin() const;

  /** \brief Number of vertices. */
  Eigen::Index
  vertices() const
  {
    return Eigen::Index(structure_.vertices);
  }

  /** \brief What a sum of the lattice has to be multiplied by: the integral of the
   * Gaussian by that of splat, blur and slice. */
  float gain() const;

  /** \brief What a one at every point sends back to it, without gain(). */
  Eigen::Map<const Eigen::ArrayXf>
  selfResponses() const
  {
    return {structure_.self_responses.data(), size()};
  }

  /** \brief Factors of N points each. */
  struct Scales {
    Eigen::ArrayXf splat;    ///< of values before they are summed
    Eigen::ArrayXf slice;    ///< of sums; gain() is not in them
    Eigen::ArrayXf diagonal; ///< of a point's own value, which is subtracted
  };

  /** \brief result(:, i) += slice_i sum_j k_ij splat_j values(:, j) - diagonal_i
   * values(:, i), j = i included.
   * \param[in] values any number of rows x N, finite
   * \param[in,out] result as values, not the same matrix */
  void addFiltered(const Eigen::Ref<const Eigen::MatrixXf>& values,
                   const Scales& scales, Eigen::Ref<Eigen::MatrixXf> result) const;

private:
  using Values = std::unique_ptr<AlignedArray<float>>;

  Values borrowValues(std::size_t size) const;

  LatticeStructure structure_;
  SimdTier tier_;

  // Values on the lattice, kept from one product to the next: to get memory costs more
  // than to fill it. One for each of the threads that have used the lattice at a time.
  mutable std::mutex mutex_;
  mutable std::vector<Values> spare_;
};

} // namespace pcl_semantic
