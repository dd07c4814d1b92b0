// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/config_parameter.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/filters/crf_parameters.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The parameters of a CRF.
 * \param[in] unit of positions, for the help: "m" or "px" */
ConfigParameters parametersOf(SemanticCRFParameters& parameters,
                              const std::string& unit);

/** \brief Settings of the programs that refine a cloud or an image. */
struct CRFConfig {
  CRFModelType model = CRFModelType::dense;
  std::string cliques = "none";  ///< where they come from; each tool has its own words
  double label_confidence = 0.8; ///< probability of the class that a label states
  SemanticCRFParameters parameters;
  int threads = 0; ///< 0 = all processors

  std::string unit = "m";   ///< of positions, for the help
  std::string clique_words; ///< what cliques may be, for the help

  /** \throws InvalidParameterException */
  void validate() const;

  /** \brief Cliques are for those models that use them, and these need some.
   * \throws InvalidParameterException */
  void requireFittingCliques() const;
};

/** \brief All parameters of a config. */
ConfigParameters parametersOf(CRFConfig& config);

} // namespace pcl_semantic
