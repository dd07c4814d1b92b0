/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/filters/crf_parameters.h>
#include <pcl_semantic/pipeline/config_parameter.h>

#include <string>

namespace pcl_semantic {

/** \brief The parameters of a CRF.
 * \param[in] prefix of the names that would say too little among others: "crf_" makes
 * `crf_iterations`
 * \param[in] unit of positions, for the help: "m" or "px" */
ConfigParameters parametersOf(SemanticCRFParameters& parameters,
                              const std::string& prefix, const std::string& unit);

/** \brief The generator a text names: `cubes:SIZE`, the edge in metres.
 * \throws InvalidParameterException if there is none such */
CliqueGenerator::Ptr makeCliqueGenerator(const std::string& text);

/** \brief What can be set of the tools that refine a cloud or an image. */
struct CRFConfig {
  CRFModelType model = CRFModelType::dense;
  std::string cliques;           ///< where they come from; each tool knows its own ways
  double label_confidence = 0.8; ///< probability of the class that a label states
  SemanticCRFParameters parameters;
  std::string unit = "m"; ///< of positions
  int threads = 0;        ///< 0 = all processors

  /** \brief Cliques have to be named by those models that use them, and by no others.
   * \throws InvalidParameterException */
  void validate() const;
};

/** \brief All parameters of a config but its cliques. */
ConfigParameters parametersOf(CRFConfig& config);

} // namespace pcl_semantic
