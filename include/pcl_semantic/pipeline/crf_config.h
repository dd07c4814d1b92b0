// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/superpixel_cliques.h>
#include <pcl_semantic/cliques/supervoxel_cliques.h>
#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/filters/crf_parameters.h>
#include <pcl_semantic/pipeline/config_parameter.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief What can be set of cliques besides the number that their word has. */
struct CliqueParameters {
  SuperpixelParameters superpixel;
  SupervoxelParameters supervoxel;

  /** \throws InvalidParameterException */
  void validate() const;
};

/** \brief All of them. */
ConfigParameters parametersOf(CliqueParameters& parameters);

/** \brief Superpixels by name: `slic`, or `slic:NUMBER` for about so many.
 * \return false if \a text does not begin so
 * \throws InvalidParameterException at a number that cannot be */
bool parseSlic(const std::string& text, SlicParameters& parameters);

/** \brief Whether a text names a generator that needs the cloud alone: `cubes`, `slic`
 * or `supervoxel`, also with a number. */
bool namesCloudCliques(const std::string& text);

/** \brief The generator a text names: `cubes:SIZE`, the edge in metres;
 * `slic[:NUMBER]`, superpixels of an organized cloud; `superpixel[:NUMBER]`, those of a
 * frame in a map. \throws InvalidParameterException if there is none such */
CliqueGenerator::Ptr
makeCliqueGenerator(const std::string& text,
                    const CliqueParameters& parameters = CliqueParameters());

/** \brief The parameters of a CRF.
 * \param[in] unit of positions, for the help: "m" or "px" */
ConfigParameters parametersOf(SemanticCRFParameters& parameters,
                              const std::string& unit);

/** \brief What can be set of the tools that refine a cloud or an image. */
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

/** \brief Sets the parameters a YAML file names; the others keep their values.
 * \param[in] path empty = no file
 * \throws BadInputException with file and line */
void readCRFConfig(const std::string& path, CRFConfig& config);

} // namespace pcl_semantic
