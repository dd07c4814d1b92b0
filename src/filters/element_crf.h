// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/filters/crf_settings.h>

#include <pcl/PointIndices.h>
#include <pcl/types.h>

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The elements that take part in a CRF: points of a cloud or pixels of an
 * image. */
struct CRFElements {
  std::size_t total = 0;      ///< elements of the whole cloud or image
  pcl::Indices indices;       ///< of the n elements that take part; no duplicates
  Eigen::MatrixXf positions;  ///< 1 to 3 rows x n, finite [m] or [px]
  Eigen::MatrixXf remainders; ///< of positions beyond single precision; empty = none
  Eigen::MatrixXf colours;    ///< rows x n [grey levels]; empty = no colour
  double spacing = 0.0;       ///< CRFReport::spacing
  double extent = 0.0;        ///< CRFReport::extent
  /// The kernels' methods; of a part of elements also the lattices of the whole.
  std::optional<GaussianKernels::Choice> choice;
  /// More elements are refined in tiles of at most as many.
  std::size_t tile_size = std::numeric_limits<std::size_t>::max();
};

/** \brief The parameters for elements, without automatic values. */
SemanticCRFParameters resolvedFor(const CRFElements& elements,
                                  const SemanticCRFParameters& parameters);

/** \brief Cliques of elements; they may overlap and leave elements out. */
using Cliques = std::vector<pcl::PointIndices>;

/** \throws InvalidParameterException that names the first clique without members */
void requireMembers(const Cliques& cliques);

/** \brief Mean of the measurements of some elements, L, sum 1 (0 without a
 * measurement). Uniform measurements do not count. The same for any order of the
 * elements. */
Eigen::VectorXd classFrequencies(const pcl::Indices& indices,
                                 const LabelDistributions& measured);

/** \brief Runs mean-field inference over elements.
 * \param[in] cliques null = none. Members that do not take part are removed. Cliques
 * without remaining members are skipped
 * \param[in,out] elements are sorted into an order that suits the kernels
 * \param[in,out] distributions L x total. Input: the measurements. Output: the refined
 * distributions of the elements that take part. An element without a measurement and
 * without messages stays unlabelled
 * \throws InvalidParameterException if the terms or cliques refer to other classes or
 * elements, or a model with cliques gets none
 * \throws BadInputException if a measurement is negative or not finite */
CRFReport refineElements(const CRFTerms& terms, const Cliques* cliques,
                         CRFElements& elements, LabelDistributions& distributions);

} // namespace pcl_semantic
