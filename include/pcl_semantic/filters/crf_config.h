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

/** \brief Settings of programs that refine a cloud or an image. */
struct CRFConfig {
  CRFModelType model = CRFModelType::dense;
  std::string cliques = "none";  ///< source of the cliques, by program
  double label_confidence = 0.8; ///< probability of the class in a label
  SemanticCRFParameters parameters;
  int threads = 0; ///< 0 = all processors

  std::string unit = "m";   ///< unit of positions, for the help
  std::string clique_words; ///< valid values of `cliques`, for the help

  /** \throws InvalidParameterException that names the parameter and its range */
  void validate() const;

  /** \throws InvalidParameterException if a model that uses cliques has none, or
   * another model has cliques */
  void requireFittingCliques() const;
};

/** \brief All parameters of a config. */
ConfigParameters parametersOf(CRFConfig& config);

} // namespace pcl_semantic
