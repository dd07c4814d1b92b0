// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <cstddef>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief What became of a run of SemanticCRF or ImageCRF. */
struct CRFReport {
  int updates = 0;                 ///< mean-field updates made
  double last_change = 0.0;        ///< largest change of a marginal in the last of them
  std::size_t unlabelled = 0;      ///< elements that take part without a measurement
  std::size_t cliques = 0;         ///< cliques that take part
  std::size_t skipped_cliques = 0; ///< cliques of which no member does
  double free_energy = 0.0;        ///< MeanField::freeEnergy(), if it was asked for
  double energy = 0.0;             ///< energy() of the MAP labels, likewise
};

} // namespace pcl_semantic
