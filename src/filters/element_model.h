// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "element_crf.h"

#include <pcl_semantic/crf/crf_model.h>

namespace pcl_semantic {

/** \brief Smallest probability of a measurement, eq. (4). */
constexpr float smallest_probability = 1e-6f;

/** \brief The kernels over positions and colours. */
struct KernelChoice {
  GaussianKernels::Choice choice;
  /// Distance over which the widest one sums, unit of the positions.
  double reach = 0.0;
};

/** \brief Chooses the kernels of all elements, for models of parts of them. */
KernelChoice chooseKernels(const CRFTerms& terms, const CRFElements& elements);

/** \brief Some columns of a matrix, in their order. */
Eigen::MatrixXf gather(const Eigen::MatrixXf& matrix, const pcl::Indices& columns);

/** \brief Builds the model over elements, eqs. (3)-(9); see refineElements().
 * \param[in] measured distributions of all elements
 * \param[in] choice that of all elements, if these are a part of them; null = of these
 * \param[in,out] report receives the numbers of cliques */
CrfModel buildModel(const CRFTerms& terms, const Cliques* cliques,
                    CRFElements& elements, const LabelDistributions& measured,
                    const GaussianKernels::Choice* choice, CRFReport& report);

} // namespace pcl_semantic
