// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "element_crf.h"

#include <pcl_semantic/crf/crf_model.h>

#include <vector>

namespace pcl_semantic {

/** \brief Smallest probability of a measurement, eq. (4). */
constexpr float smallest_probability = 1e-6f;

/** \brief The kernels over positions and colours. */
struct KernelChoice {
  GaussianKernels::Choice choice;
  /// Distance over which the widest one sums, unit of the positions.
  double reach = 0.0;
};

/** \brief Chooses the kernels of all elements, for models of parts of them.
 * \param[in] density as in GaussianKernels::choose() */
KernelChoice chooseKernels(const CRFTerms& terms, const CRFElements& elements,
                           double density = 1.0);

/** \brief The choice for a part of a cloud.
 * \param[in] methods of the terms
 * \param[in] low least coordinates of the cloud, in the frame of the part
 * \param[in] colour_low least colours of the cloud; empty = no colour */
GaussianKernels::Choice choiceFor(const SemanticCRFParameters& resolved,
                                  const std::vector<KernelMethod>& methods,
                                  const Eigen::MatrixXf& low,
                                  const Eigen::MatrixXf& colour_low);

/** \brief Moves the origin of the positions that a choice is for. */
void moveOrigin(const CRFTerms& terms, const CRFElements& elements,
                const Eigen::VectorXf& origin, GaussianKernels::Choice& choice);

/** \brief Width of the surroundings that a part of the elements needs, in reaches of
 * the kernels (doc/crf.md#large-clouds).
 * \param[in] unlabelled number of elements without a measurement
 * \param[in] elements number of all elements */
double haloOf(std::size_t unlabelled, std::size_t elements, int updates);

/** \brief Some columns of a matrix, in their order. */
Eigen::MatrixXf gather(const Eigen::Ref<const Eigen::MatrixXf>& matrix,
                       const pcl::Indices& columns);

/** \brief Median of each row over some columns, at least one. */
Eigen::VectorXf medianOf(const Eigen::Ref<const Eigen::MatrixXf>& matrix,
                         const pcl::Indices& columns);

/** \brief Builds the model over elements, eqs. (3)-(9); see refineElements().
 * \param[in] measured distributions of all elements
 * \param[in,out] report receives the numbers of cliques */
CrfModel buildModel(const CRFTerms& terms, const Cliques* cliques,
                    CRFElements& elements, const LabelDistributions& measured,
                    CRFReport& report);

} // namespace pcl_semantic
