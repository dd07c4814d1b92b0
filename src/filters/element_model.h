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
  double reach =
      0.0; ///< distance over which the widest one sums, unit of the positions
};

/** \brief Chooses the kernels for all elements. */
KernelChoice chooseKernels(const CRFTerms& terms, const CRFElements& elements);

/** \brief Builds the model over elements, eqs. (3)-(9); see refineElements().
 * \param[in] measured distributions of all elements
 * \param[in] kernels those of all elements, if these are a part of them
 * \param[in,out] report receives the numbers of cliques */
CrfModel buildModel(const CRFTerms& terms, const Cliques* cliques,
                    CRFElements& elements, const LabelDistributions& measured,
                    const KernelChoice& kernels, CRFReport& report);

} // namespace pcl_semantic
