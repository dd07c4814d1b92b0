// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/filters/crf_settings.h>

#include <pcl/PointIndices.h>
#include <pcl/types.h>

#include <cstddef>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The elements of a CRF that take part: points of a cloud, pixels of an image.
 */
struct CRFElements {
  std::size_t total = 0;     ///< elements of the whole cloud or image
  pcl::Indices indices;      ///< of the n that take part, each once
  Eigen::MatrixXf positions; ///< 1 to 3 rows x n, finite
  Eigen::MatrixXf colours;   ///< rows x n [grey levels]; empty = no colour
  double spacing = 0.0;      ///< CRFReport::spacing
};

/** \brief Cliques of elements; they may overlap and leave elements out. */
using Cliques = std::vector<pcl::PointIndices>;

/** \throws InvalidParameterException that names the first clique without members */
void requireMembers(const Cliques& cliques);

/** \brief Runs mean field over elements.
 * \param[in] cliques null = none. Members that take no part are left out, and cliques
 * that lose all are skipped
 * \param[in,out] elements are brought into the order that suits the kernels
 * \param[in,out] distributions of the whole cloud or image: the columns of the elements
 * hold their measurements and then the refined distributions; an element without
 * measurement that receives no message stays unlabelled
 * \throws InvalidParameterException if terms or cliques do not fit
 * \throws BadInputException if a measurement is negative or not finite */
CRFReport refineElements(const CRFTerms& terms, const Cliques* cliques,
                         CRFElements& elements, LabelDistributions& distributions);

} // namespace pcl_semantic
