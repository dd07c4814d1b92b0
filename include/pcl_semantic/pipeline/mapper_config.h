// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/superpixel_cliques.h>
#include <pcl_semantic/cliques/supervoxel_cliques.h>
#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/filters/crf_parameters.h>
#include <pcl_semantic/map/semantic_voxel_map.h>

#include <Eigen/Core>

#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A value that is one of several words. */
struct ConfigChoice {
  std::vector<std::string> words; ///< of the values 0, 1, ...
  std::function<int()> get;
  std::function<void(int)> set;
};

/** \brief A choice for an enumeration whose values are 0, 1, ... in the order of the
 * words. */
template <typename Enum>
ConfigChoice
chooseFrom(Enum& value, std::vector<std::string> words)
{
  return {std::move(words), [&value] { return static_cast<int>(value); },
          [&value](int number) { value = static_cast<Enum>(number); }};
}

/** \brief One parameter of a configuration: its name (`voxel_size` in a YAML file,
 * `--voxel-size` as an option), what it means, and where its value is. */
struct ConfigParameter {
  using Value =
      std::variant<bool*, int*, double*, std::string*, Eigen::Vector3d*, ConfigChoice>;

  std::string name;
  std::string help;
  Value value;
  std::string old_name{}; ///< that is still understood; empty = none

  /** \brief Name of the option: dashes for underscores. */
  std::string option() const;

  /** \brief The old name as an option; empty = none. */
  std::string oldOption() const;

  /** \brief The value as text: "0.1", "25,25,8", "true". */
  std::string text() const;

  /** \brief Sets the value from text.
   * \param[in] where for the message
   * \throws BadInputException if \a text cannot be read */
  void set(const std::string& text, const std::string& where);
};

using ConfigParameters = std::vector<ConfigParameter>;

/** \brief "a, b or c". */
std::string joinWords(const std::vector<std::string>& words);

/** \brief Sets the parameters a YAML file names; the others keep their values.
 * \throws BadInputException with file and line, at a misspelt key for example */
void readParameters(const std::string& path, ConfigParameters parameters);

/** \brief The parameters as a YAML file that readParameters takes. */
std::string printParameters(const ConfigParameters& parameters);

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
  std::string pixel_fusion = "mean"; ///< PixelFusion by name
  std::string clearing = "careful";  ///< Clearing by name
  std::string crf = "dense";         ///< none, dense, pn-potts or hierarchical
  int crf_every = 1;           ///< 1 = the CRF runs at each frame, 2 = at every other
  bool crf_write_back = false; ///< what it concludes is the prior of later frames
  std::string cliques = "cubes:1"; ///< of the last two, as makeCliqueGenerator takes
  CliqueParameters clique_parameters;
  std::string clique_exclude = "none";   ///< classes with commas between: voxels that
                                         ///< are likely one of them are in no clique
  double clique_exclude_threshold = 0.3; ///< this likely
  SemanticCRFParameters crf_parameters = SemanticCRFParameters::forMaps();
  int threads = 0; ///< 0 = all processors

  /** \brief Carries pixel_fusion and clearing into map and checks every value.
   * \throws InvalidParameterException */
  void validate();

  /** \brief The model that `crf` names, if it is not none. */
  CRFModelType crfModel() const;
};

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
