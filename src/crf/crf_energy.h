// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/crf/crf_model.h>

#include <vector>

namespace pcl_semantic {

/** \brief The energy of a labelling, eq. (9) of the paper without the minimum: unary
 * and pairwise costs (each pair once) plus those of the cliques.
 *
 * Of a kernel that is not symmetric its symmetric part counts; self-interaction is no
 * part of the energy.
 * \param[in] x labels of the N variables, from 0
 * \param[in] y labels of the cliques of all robust potentials, one potential after the
 * other, from 0; L = the free label
 * \throws InvalidParameterException as CrfModel::validate(); if x or y have another
 * size or a label out of range; if the compatibility is not symmetric */
double energy(const CrfModel& model, const std::vector<int>& x,
              const std::vector<int>& y);

} // namespace pcl_semantic
