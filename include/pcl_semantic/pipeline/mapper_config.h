/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/filters/semantic_crf.h>
#include <pcl_semantic/map/semantic_voxel_map.h>

#include <string>
#include <variant>
#include <vector>

namespace pcl_semantic {

/** \brief Everything that can be set of SemanticMapper. doc/parameters.md has the
 * reasons for the defaults. */
struct MapperConfig {
  int disparities = 128;         ///< range of the stereo search [px]
  int stereo_block = 5;          ///< edge of a matching block [px]
  double label_confidence = 0.8; ///< probability of the class a stored `.png` states
  SemanticVoxelMap::Parameters map;
  std::string pixel_fusion = "mean"; ///< PixelFusion by name
  std::string crf = "dense";         ///< dense or none
  int crf_every = 1; ///< 1 = the CRF runs at each frame, 2 = at every other
  SemanticCRFParameters crf_parameters;
  int threads = 0; ///< 0 = all processors

  /** \brief Carries pixel_fusion into map and checks every value.
   * \throws InvalidParameterException */
  void validate();
};

/** \brief One parameter of a MapperConfig: its name (`voxel_size` in a YAML file,
 * `--voxel-size` as an option), what it means, and where its value is. */
struct ConfigParameter {
  using Value = std::variant<int*, double*, std::string*, Eigen::Vector3d*>;

  std::string name;
  std::string help;
  Value value;

  /** \brief Name of the option: dashes for underscores. */
  std::string option() const;

  /** \brief The value as text: "0.1", "25,25,8". */
  std::string text() const;

  /** \brief Sets the value from text.
   * \param[in] where for the message
   * \throws BadInputException if \a text cannot be read */
  void set(const std::string& text, const std::string& where);
};

/** \brief The parameters of a config, in the order of the data flow. */
std::vector<ConfigParameter> parametersOf(MapperConfig& config);

/** \brief Sets the parameters a YAML file names; the others keep their values.
 * \throws BadInputException with file and line, at a misspelt key for example */
void readMapperConfig(const std::string& path, MapperConfig& config);

/** \brief The whole config as a YAML file that readMapperConfig takes. */
std::string printMapperConfig(const MapperConfig& config);

} // namespace pcl_semantic
