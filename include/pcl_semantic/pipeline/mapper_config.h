// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/filters/crf_config.h>
#include <pcl_semantic/map/semantic_voxel_map.h>
#include <pcl_semantic/superpixels/clique_config.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Everything that can be set of SemanticMapper. doc/parameters.md has the
 * reasons for the defaults. */
struct MapperConfig {
  std::string stereo = "sgm"; ///< engine, one of disparityEngines()
  int disparities = 128;      ///< range of the stereo search [px]
  double max_deviation = 0.0; ///< less sure disparities give no depth [px]; 0 = all do
  double deviation_scale = 0.0;  ///< of the depth-deviation model; 0 = none
  double min_hit_ratio = 0.33;   ///< see eraseSeenThrough(); 0 = off
  double label_confidence = 0.8; ///< probability of the class a stored `.png` states
  int network_every = 1; ///< 1 = the labels of each frame count, 3 = of every third
  SemanticVoxelMap::Parameters map;
  CRFModelType crf = CRFModelType::dense; ///< unary: the CRF is not run
  int crf_every = 1;           ///< 1 = the CRF runs at each frame, 2 = at every other
  bool crf_write_back = false; ///< what it concludes is the prior of later frames
  std::string cliques = "cubes:1"; ///< of the last two, as makeCliqueGenerator takes
  CliqueParameters clique_parameters;
  std::string clique_exclude = "none"; ///< classes with commas between: voxels that
                                       ///< are likely one of them are in no clique
  SemanticCRFParameters crf_parameters = SemanticCRFParameters::forMaps();
  int threads = 0; ///< 0 = all processors

  /** \brief Checks every value, and passes the voxel size on to the supervoxels.
   * \throws InvalidParameterException */
  void validate();
};

/** \brief The value of `crf` that selects a model: none, dense, pn-potts or
 * hierarchical. */
const std::string& nameOf(CRFModelType model);

/** \brief The parameters of a config, in the order of the data flow. */
ConfigParameters parametersOf(MapperConfig& config);

/** \brief The labels of class names with commas between them; of "none" there are none.
 * \param[in] what has the list, for messages: "--ground"
 * \throws InvalidParameterException at a name that is not in the label set */
std::vector<Label> listedLabels(const std::string& names, const LabelSet& label_set,
                                const std::string& what);

/** \brief Sets the parameters a YAML file names; the others keep their values.
 * \param[in] path empty = no file
 * \throws BadInputException with file and line, at a misspelt key for example */
void readMapperConfig(const std::string& path, MapperConfig& config);

/** \brief The whole config as a YAML file that readMapperConfig takes. */
std::string printMapperConfig(const MapperConfig& config);

} // namespace pcl_semantic
