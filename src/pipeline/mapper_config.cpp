/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/yaml_config.h>
#include <pcl_semantic/pipeline/mapper_config.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace pcl_semantic {

namespace {

template <typename... Visitors> struct Overloaded : Visitors... {
  using Visitors::operator()...;
};
template <typename... Visitors> Overloaded(Visitors...) -> Overloaded<Visitors...>;

int
parseInteger(const std::string& text, const std::string& where)
{
  const double value = parseNumber(text, where);
  if (value != std::floor(value) || std::abs(value) > 1e9)
    PCL_THROW_EXCEPTION(BadInputException,
                        where << ": '" << text << "' is no integer up to 1e9");
  return static_cast<int>(value);
}

Eigen::Vector3d
parseVector(std::string text, const std::string& where)
{
  std::replace(text.begin(), text.end(), ',', ' ');
  const std::vector<double> numbers = parseNumbers(text, where);
  if (numbers.size() != 3)
    PCL_THROW_EXCEPTION(BadInputException,
                        where << ": '" << text << "' is no X,Y,Z triple");
  return {numbers[0], numbers[1], numbers[2]};
}

std::string
printNumber(double value)
{
  std::ostringstream text;
  text << value;
  return text.str();
}

void
requireChoice(const std::string& value, const std::vector<std::string>& choices,
              const char* name)
{
  if (std::count(choices.begin(), choices.end(), value))
    return;
  std::string expected;
  for (const std::string& choice : choices)
    expected += (expected.empty() ? "" : " or ") + choice;
  PCL_THROW_EXCEPTION(InvalidParameterException,
                      name << " is '" << value << "', expected " << expected);
}

// The text of a value in a YAML file; a triple may also be written as a list.
std::string
yamlText(const YamlMap& file, const ConfigParameter& parameter)
{
  if (!std::holds_alternative<Eigen::Vector3d*>(parameter.value))
    return file.require<std::string>(parameter.name);
  std::vector<std::string> items;
  try {
    items = file.require<std::vector<std::string>>(parameter.name);
  }
  catch (const BadInputException&) {
    return file.require<std::string>(parameter.name);
  }
  std::string text;
  for (const std::string& item : items)
    text += item + " ";
  return text;
}

} // namespace

void
MapperConfig::validate()
{
  requireChoice(pixel_fusion, {"mean", "product"}, "pixel_fusion");
  requireChoice(crf, {"dense", "none"}, "crf");
  map.fusion.pixel_fusion =
      pixel_fusion == "mean" ? PixelFusion::mean : PixelFusion::product;
  if (!(map.max_range > 0.0))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "max_depth is " << map.max_range << " m, expected more than 0");
  map.validate();
  crf_parameters.validate();
  if (crf_every < 1)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "crf_every is " << crf_every << ", expected 1 or more");
  if (!(label_confidence > 0.0 && label_confidence <= 1.0))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "label_confidence is " << label_confidence
                                               << ", expected more than 0, at most 1");
}

std::string
ConfigParameter::option() const
{
  std::string option = name;
  std::replace(option.begin(), option.end(), '_', '-');
  return option;
}

std::string
ConfigParameter::text() const
{
  return std::visit(Overloaded{[](const int* v) { return std::to_string(*v); },
                               [](const double* v) { return printNumber(*v); },
                               [](const std::string* v) { return *v; },
                               [](const Eigen::Vector3d* v) {
                                 return printNumber(v->x()) + "," +
                                        printNumber(v->y()) + "," + printNumber(v->z());
                               }},
                    value);
}

void
ConfigParameter::set(const std::string& text, const std::string& where)
{
  std::visit(Overloaded{[&](int* v) { *v = parseInteger(text, where); },
                        [&](double* v) { *v = parseNumber(text, where); },
                        [&](std::string* v) { *v = text; },
                        [&](Eigen::Vector3d* v) { *v = parseVector(text, where); }},
             value);
}

std::vector<ConfigParameter>
parametersOf(MapperConfig& config)
{
  FusionParameters& fusion = config.map.fusion;
  SemanticCRFParameters& crf = config.crf_parameters;
  return {
      {"disparities", "range of the stereo search, a multiple of 16 [px]",
       &config.disparities},
      {"stereo_block", "edge of a matching block, odd [px]", &config.stereo_block},
      {"label_confidence", "probability of the class that a stored .png states",
       &config.label_confidence},
      {"voxel_size", "edge of a voxel [m]", &config.map.voxel_size},
      {"window", "extent of the window around the camera: X,Y,Z, world axes [m]",
       &config.map.window},
      {"max_depth", "pixels beyond this depth only clear space [m]",
       &config.map.max_range},
      {"hit_probability", "of being occupied, given a hit", &fusion.hit_probability},
      {"miss_probability", "of being occupied, given a ray through it",
       &fusion.miss_probability},
      {"min_probability", "clamp of occupancy from below", &fusion.min_probability},
      {"max_probability", "clamp of occupancy from above", &fusion.max_probability},
      {"occupied_probability", "occupied at or above", &fusion.occupied_probability},
      {"pixel_fusion", "pixels of a frame in one voxel: mean or product",
       &config.pixel_fusion},
      {"label_min_probability", "clamp of each label measurement from below",
       &fusion.label_min_probability},
      {"label_max_ratio", "clamp of a fused distribution: largest / smallest",
       &fusion.label_max_ratio},
      {"crf", "model: dense or none", &config.crf},
      {"crf_every", "the CRF runs at the first and every N-th frame after it",
       &config.crf_every},
      {"crf_iterations", "mean-field updates a run", &crf.iterations},
      {"crf_radius", "kernels are summed within this many deviations", &crf.radius},
      {"smoothness_weight", "of the kernel of positions", &crf.smoothness_weight},
      {"smoothness_deviation", "of positions, in that kernel [m]",
       &crf.smoothness_deviation},
      {"appearance_weight", "of the kernel of positions and colours",
       &crf.appearance_weight},
      {"appearance_deviation", "of positions, in that kernel [m]",
       &crf.appearance_deviation},
      {"colour_deviation", "of colours, in that kernel [grey levels]",
       &crf.colour_deviation},
      {"threads", "0 = all processors", &config.threads}};
}

void
readMapperConfig(const std::string& path, MapperConfig& config)
{
  const YamlMap file = YamlMap::load(path);
  for (ConfigParameter& parameter : parametersOf(config))
    if (file.has(parameter.name))
      parameter.set(yamlText(file, parameter), file.where(parameter.name));
  file.refuseUnknownKeys();
  try {
    config.validate();
  }
  catch (const InvalidParameterException& error) {
    PCL_THROW_EXCEPTION(BadInputException, path << ": " << error.what());
  }
}

std::string
printMapperConfig(const MapperConfig& config)
{
  MapperConfig copy = config;
  std::ostringstream text;
  for (const ConfigParameter& parameter : parametersOf(copy)) {
    const bool is_list = std::holds_alternative<Eigen::Vector3d*>(parameter.value);
    text << parameter.name << ": "
         << (is_list ? "[" + parameter.text() + "]" : parameter.text()) << "  # "
         << parameter.help << "\n";
  }
  return text.str();
}

} // namespace pcl_semantic
