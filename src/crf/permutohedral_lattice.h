// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/crf/pairwise_kernel.h>

#include <Eigen/Core>

#include <memory>
#include <vector>

namespace pcl_semantic {

/** \brief In which order a lattice is blurred along its directions. Where vertices are
 * missing the orders differ: from the first to the last, as the paper does, is not a
 * symmetric map then. The mean of that and of the reverse is one, and nearer to the
 * Gaussian; it takes half as long again. */
enum class LatticeBlur { symmetric, forward };

/** \brief The permutohedral lattice of Adams, Baek and Davis (2010): sums with the
 * Gaussian k_ij = exp(-|f_i - f_j|^2 / 2) of N points in time linear in N, near enough.
 *
 * Values are splatted to the vertices of the simplex around their point, blurred with
 * the taps 1/2 1 1/2 along every direction in turn, and sliced where they are asked
 * for. Vertices around no point do not exist: what would pass through them is lost. The
 * lattice lies the same way around the least features of the points, wherever these
 * are. Results do not depend on the number of threads, nor on the SIMD tier; several
 * threads may use one lattice at a time. */
class PermutohedralLattice {
public:
  /** \param[in] features d x N, divided by their deviations; d is 1 to 16
   * \param[in] tier instructions to use; for tests
   * \throws InvalidParameterException if a feature is not finite, d is not 1 to 16, or
   * features span so many deviations that the keys of vertices (128 bits) cannot tell
   * them apart: not below 50 at d = 16, more at fewer */
  explicit PermutohedralLattice(const Eigen::Ref<const Eigen::MatrixXf>& features,
                                SimdTier tier = simdTier());

  /** \brief A lattice around the same points in another space of features, to be
   * filtered together with a \a neighbour.
   * \throws InvalidParameterException as above, or if their points are not as many */
  PermutohedralLattice(const Eigen::Ref<const Eigen::MatrixXf>& features,
                       const PermutohedralLattice& neighbour,
                       SimdTier tier = simdTier());
  ~PermutohedralLattice();
  PermutohedralLattice(PermutohedralLattice&&) noexcept;
  PermutohedralLattice& operator=(PermutohedralLattice&&) noexcept;

  /** \brief N. */
  Eigen::Index size() const;

  /** \brief Features at which a vertex lies: 0 to 1 less than the least of the points.
   */
  Eigen::VectorXd origin() const;

  /** \brief Number of vertices. */
  Eigen::Index vertices() const;

  /** \brief What a sum of the lattice has to be multiplied by: the integral of the
   * Gaussian by that of splat, blur and slice. */
  float gain() const;

  /** \brief What a one at every point sends back to it, without gain(). */
  Eigen::Map<const Eigen::ArrayXf> selfResponses() const;

  /** \brief Factors of N points each. */
  struct Scales {
    Eigen::ArrayXf splat;    ///< of values before they are summed
    Eigen::ArrayXf slice;    ///< of sums; gain() is not in them
    Eigen::ArrayXf diagonal; ///< of a point's own value, which is subtracted
  };

  /** \brief A lattice and its scales. */
  struct Term {
    const PermutohedralLattice* lattice;
    const Scales* scales;
  };

  /** \brief For every term result(:, i) += slice_i sum_j k_ij splat_j values(:, j) -
   * diagonal_i values(:, i), j = i included.
   * \param[in] values any number of rows x N, finite
   * \param[in] terms of lattices that are neighbours of the first one
   * \param[in,out] result as values, not the same matrix
   * \throws InvalidParameterException if lattices are not neighbours */
  static void addFiltered(const Eigen::Ref<const Eigen::MatrixXf>& values,
                          const std::vector<Term>& terms,
                          Eigen::Ref<Eigen::MatrixXf> result,
                          LatticeBlur blur = LatticeBlur::symmetric);

  /** \brief Bytes that the lattice keeps, those for its values at the vertices (of up
   * to 16 rows at a time) included. */
  std::size_t memory(LatticeBlur blur = LatticeBlur::symmetric) const;

private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

} // namespace pcl_semantic
