// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/filters/crf_config.h>
#include <pcl_semantic/map/semantic_voxel_map.h>
#include <pcl_semantic/superpixels/clique_config.h>
#include <pcl_semantic/things/object_tracker.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief All parameters of SemanticMapper. doc/parameters.md explains the defaults. */
struct MapperConfig {
  std::string stereo = "sgm";    ///< engine, one of disparityEngines()
  int disparities = 128;         ///< range of the stereo search [px]
  double max_deviation = 0.0;    ///< deviation limit of disparities [px]; 0 = none
  double deviation_scale = 0.0;  ///< factor on the deviations of depths; 0 = none
  double min_hit_ratio = 0.33;   ///< see eraseSeenThrough(); 0 = off
  double label_confidence = 0.8; ///< probability of the class in a stored `.png`
  int network_every = 1;         ///< uses the labels of every n-th frame
  SemanticVoxelMap::Parameters map;
  CRFModelType crf = CRFModelType::dense; ///< unary: the CRF is not run
  int crf_every = 1;                      ///< runs the CRF at every n-th frame
  bool crf_write_back = false;    ///< uses the CRF's result as prior of later frames
  std::string cliques = "planes"; ///< method for the last two models, see
                                  ///< makeCliqueGenerator()
  CliqueParameters clique_parameters;
  SemanticCRFParameters crf_parameters = SemanticCRFParameters::forMaps();
  bool things =
      true; ///< tracks the objects of classes marked `thing`, if there are any
  ObjectTracker::Parameters objects;
  int threads = 0; ///< 0 = all processors

  /** \brief Checks every value, and passes on the voxel size to the supervoxels.
   * \throws InvalidParameterException that names the parameter and its range */
  void validate();
};

/** \brief The value of `crf` that selects a model: none, dense, pn-potts or
 * hierarchical. */
const std::string& nameOf(CRFModelType model);

/** \brief The parameters of a config, in the order of the data flow. */
ConfigParameters parametersOf(MapperConfig& config);

/** \brief Parses class names separated by commas; "none" gives an empty list.
 * \param[in] what name of the list, for messages: "--ground"
 * \throws InvalidParameterException at a name that is not in the label set */
std::vector<Label> listedLabels(const std::string& names, const LabelSet& label_set,
                                const std::string& what);

/** \brief Sets the parameters in a YAML file; the others keep their values.
 * \param[in] path empty = no file
 * \throws BadInputException with file and line, for example at an unknown key */
void readMapperConfig(const std::string& path, MapperConfig& config);

/** \brief Prints the config as a YAML file for readMapperConfig(). */
std::string printMapperConfig(const MapperConfig& config);

} // namespace pcl_semantic
