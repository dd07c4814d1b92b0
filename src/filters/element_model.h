// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "element_crf.h"

#include <pcl_semantic/crf/crf_model.h>

namespace pcl_semantic {

/** \brief Smallest probability of a measurement, eq. (4). */
constexpr float smallest_probability = 1e-6f;

/** \brief Builds the model over elements, eqs. (3)-(9); see refineElements().
 * \param[in] measured distributions of all elements
 * \param[in,out] report receives the numbers of cliques */
CrfModel buildModel(const CRFTerms& terms, const Cliques* cliques,
                    CRFElements& elements, const LabelDistributions& measured,
                    CRFReport& report);

} // namespace pcl_semantic
