// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/crf/pairwise_kernel.h>

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A weighted Gaussian over positions and optional further features: w exp(-|p_i
 * - p_j|^2 / 2 sigma^2 - |f_i - f_j|^2 / 2), a term of eq. (6) with the square that is
 * missing in the paper. */
struct GaussianTerm {
  float weight = 1.0f;
  float position_deviation = 1.0f; ///< sigma, in the unit of the positions
  Eigen::MatrixXf
      features; ///< d x N, divided by their deviations; empty = positions only

  /** \throws InvalidParameterException if the deviation is not positive, the weight is
   * negative, the features have not one column per point, or a value is not finite */
  void validate(Eigen::Index points) const;
};

/** \brief Method that sums Gaussian kernels. */
enum class KernelMethod {
  automatic, ///< per term, see GaussianKernels
  truncated, ///< all pairs within a radius (TruncatedKernel): features of any
             ///< dimension, as long as positions have few neighbours
  lattice    ///< permutohedral lattice (LatticeKernel): cost does not depend on the
             ///< number of pairs
};

struct GaussianKernelOptions {
  KernelMethod method = KernelMethod::automatic;
  float radius = 2.0f; ///< radius of truncated sums, in position deviations
  Normalization normalization = Normalization::symmetric;
};

/** \brief Makes the kernels of points in space, eq. (6): chooses a method for each term
 * and the order of points that suits the methods.
 *
 * The automatic rule estimates the mean number of neighbours within the radius from a
 * sample. Up to max_neighbours, truncated sums are faster than a lattice and more
 * accurate. The voxels of a surface have 40 to 150 neighbours within two deviations of
 * two voxels; the pixels of an image have 20,000 within 80 px. */
class GaussianKernels {
public:
  using List = std::vector<std::shared_ptr<const PairwiseKernel>>;

  /** \brief Number of neighbours above which the automatic rule selects the lattice. */
  static constexpr double max_neighbours = 200.0;

  /** \param[in] positions 1 to 3 rows x N
   * \param[in] deviations of the positions, for every term
   * \throws InvalidParameterException if there are no or more than 3 rows, a deviation
   * or the radius is not positive, a position is not finite, or as TruncatedKernel */
  GaussianKernels(const Eigen::MatrixXf& positions,
                  const std::vector<float>& deviations,
                  const GaussianKernelOptions& options = {});

  /** \brief The choices for a cloud, with which a part of it has the same kernels. */
  struct Choice {
    std::vector<KernelMethod> methods; ///< of the terms
    std::vector<Eigen::VectorXf> lows; ///< least features of the lattices, positions
                                       ///< first; empty = of the part
  };

  /** \brief As above, with given choices. A term whose truncated sums cannot hold the
   * positions has a lattice. */
  GaussianKernels(const Eigen::MatrixXf& positions,
                  const std::vector<float>& deviations,
                  const GaussianKernelOptions& options, Choice choice);

  /** \brief Chooses for a cloud.
   * \param[in] terms whose features belong to \a positions
   * \param[in] density points of the cloud for each of \a positions, if these are a
   * random sample of it
   * \throws as the constructor */
  static Choice choose(const Eigen::MatrixXf& positions,
                       const std::vector<GaussianTerm>& terms,
                       const GaussianKernelOptions& options, double density = 1.0);

  /** \brief The method of a term: truncated or lattice. */
  KernelMethod
  method(std::size_t term) const
  {
    return choice_.methods[term];
  }

  /** \brief The order of points in which the kernels are fastest; empty = the given
   * order. */
  const std::vector<std::int32_t>&
  fastestOrder() const
  {
    return order_;
  }

  /** \brief Makes the kernels.
   * \param[in] positions those of the constructor, or the same in fastestOrder()
   * \param[in] terms with the deviations of the constructor; their features belong to
   * \a positions. Terms of weight 0 are left out.
   * \param[in] before is called before each kernel, and may throw; null = none
   * \throws InvalidParameterException as TruncatedKernel and LatticeKernel */
  List make(const Eigen::MatrixXf& positions, const std::vector<GaussianTerm>& terms,
            const std::function<void()>& before = nullptr) const;

  /** \brief Points that meanNeighbours() looks at. */
  static constexpr std::size_t max_sample = 8192;

  /** \brief Mean number of points within \a reach of a point, itself included;
   * estimated from 64 points. If there are more than max_sample, their neighbours are
   * sampled too. */
  static double meanNeighbours(const Eigen::Matrix3Xf& positions, float reach);

private:
  GaussianKernelOptions options_;
  Choice choice_;
  std::vector<std::int32_t> order_;
};

} // namespace pcl_semantic
