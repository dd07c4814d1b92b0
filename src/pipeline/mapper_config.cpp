// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/mapper_config.h>

#include "cliques/slic_cliques.h"
#include "core/fail.h"
#include "core/split.h"
#include "files/yaml_config.h"

#include <pcl_semantic/cliques/cube_cliques.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/stereo/disparity_engines.h>

#include <algorithm>
#include <cmath>

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
    badInput(where, ": '", text, "' is no integer up to 1e9");
  return static_cast<int>(value);
}

Eigen::Vector3d
parseVector(std::string text, const std::string& where)
{
  std::replace(text.begin(), text.end(), ',', ' ');
  const std::vector<double> numbers = parseNumbers(text, where);
  if (numbers.size() != 3)
    badInput(where, ": '", text, "' is no X,Y,Z triple");
  return {numbers[0], numbers[1], numbers[2]};
}

std::string
printNumber(double value)
{
  TextStream text;
  text << value;
  return text.str();
}

int
parseChoice(const std::string& text, const std::vector<std::string>& words,
            const std::string& where)
{
  const auto word = std::find(words.begin(), words.end(), text);
  if (word == words.end())
    badInput(where, ": '", text, "', expected ", joinWords(words));
  return int(word - words.begin());
}

// The text of a value in a YAML file; a triple may also be written as a list.
std::string
yamlText(const YamlMap& file, const std::string& key, bool is_triple)
{
  if (!is_triple)
    return file.require<std::string>(key);
  std::vector<std::string> items;
  try {
    items = file.require<std::vector<std::string>>(key);
  }
  catch (const BadInputException&) {
    return file.require<std::string>(key);
  }
  std::string text;
  for (const std::string& item : items)
    text += item + " ";
  return text;
}

std::string
withDashes(std::string name)
{
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

void
append(ConfigParameters& to, ConfigParameters from)
{
  for (ConfigParameter& parameter : from)
    to.push_back(std::move(parameter));
}

template <typename Config>
void
readConfig(const std::string& path, Config& config)
{
  if (path.empty())
    return;
  readParameters(path, parametersOf(config));
  try {
    config.validate();
  }
  catch (const InvalidParameterException& error) {
    badInput(path, ": ", error.what());
  }
}

template <typename T>
void
require(bool is_valid, const char* name, T value, const char* expected)
{
  if (!is_valid)
    badParameter(name, " is ", value, ", expected ", expected);
}

void
requireConfidence(double value)
{
  require(value > 0.0 && value <= 1.0, "label_confidence", value,
          "more than 0, at most 1");
}

} // namespace

std::string
ConfigParameter::option() const
{
  return withDashes(name);
}

std::string
ConfigParameter::oldOption() const
{
  return withDashes(old_name);
}

std::string
ConfigParameter::text() const
{
  return std::visit(
      Overloaded{[](const bool* v) { return std::string(*v ? "true" : "false"); },
                 [](const ConfigChoice& v) { return v.words.at(std::size_t(v.get())); },
                 [](const int* v) { return std::to_string(*v); },
                 [](const double* v) { return printNumber(*v); },
                 [](const std::string* v) { return *v; },
                 [](const Eigen::Vector3d* v) {
                   return printNumber(v->x()) + "," + printNumber(v->y()) + "," +
                          printNumber(v->z());
                 }},
      value);
}

void
ConfigParameter::set(const std::string& text, const std::string& where)
{
  std::visit(Overloaded{[&](bool* v) {
                          *v = parseChoice(text, {"false", "true"}, where) == 1;
                        },
                        [&](const ConfigChoice& v) {
                          v.set(parseChoice(text, v.words, where));
                        },
                        [&](int* v) { *v = parseInteger(text, where); },
                        [&](double* v) { *v = parseNumber(text, where); },
                        [&](std::string* v) { *v = text; },
                        [&](Eigen::Vector3d* v) { *v = parseVector(text, where); }},
             value);
}

std::string
joinWords(const std::vector<std::string>& words)
{
  std::string joined;
  for (std::size_t i = 0; i < words.size(); ++i)
    joined += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return joined;
}

void
readParameters(const std::string& path, ConfigParameters parameters)
{
  const YamlMap file = YamlMap::load(path);
  for (ConfigParameter& parameter : parameters) {
    const bool is_triple = std::holds_alternative<Eigen::Vector3d*>(parameter.value);
    for (const std::string& key : {parameter.name, parameter.old_name})
      if (!key.empty() && file.has(key)) {
        parameter.set(yamlText(file, key, is_triple), file.where(key));
        break; // the old name beside the new one is an unknown key
      }
  }
  file.refuseUnknownKeys();
}

std::string
printParameters(const ConfigParameters& parameters)
{
  TextStream text;
  for (const ConfigParameter& parameter : parameters) {
    const bool is_list = std::holds_alternative<Eigen::Vector3d*>(parameter.value);
    text << parameter.name << ": "
         << (is_list ? "[" + parameter.text() + "]" : parameter.text()) << "  # "
         << parameter.help << "\n";
  }
  return text.str();
}

namespace {

double
numberAfterColon(const std::string& text)
{
  try {
    return parseNumber(text.substr(text.find(':') + 1), "cliques '" + text + "'");
  }
  catch (const BadInputException& error) {
    badParameter(error.what());
  }
}

// `word` or `word:NUMBER`; false if the text is something else.
bool
parseSuperpixels(const std::string& text, const std::string& word,
                 SlicParameters& parameters)
{
  if (text == word)
    return true;
  if (text.rfind(word + ":", 0) != 0)
    return false;
  const double number = numberAfterColon(text);
  if (!(number >= 1.0 && number <= 65536.0) || number != std::floor(number))
    badParameter("cliques are '", text, "', expected ", word, ":N with N 1 to 65536");
  parameters.superpixels = int(number);
  return true;
}

} // namespace

void
CliqueParameters::validate() const
{
  superpixel.validate();
  supervoxel.validate();
}

ConfigParameters
parametersOf(CliqueParameters& parameters)
{
  SuperpixelParameters& superpixel = parameters.superpixel;
  SupervoxelParameters& supervoxel = parameters.supervoxel;
  return {
      {"superpixel_keep", "keep voxels that are out of view in their last superpixel",
       &superpixel.keep},
      {"superpixel_depth_jump",
       "split superpixels where the line through the points of neighbouring pixels "
       "passes the camera closer than this [m]; 0 = off",
       &superpixel.passing_distance},
      {"superpixel_compactness",
       "compactness of superpixels: high = square, low = along colour edges",
       &superpixel.slic.compactness},
      {"supervoxel_resolution", "voxel size of the supervoxel clustering [m]",
       &supervoxel.voxel_resolution},
      {"supervoxel_colour_weight", "weight of colour in the supervoxel clustering",
       &supervoxel.colour_weight},
      {"supervoxel_spatial_weight", "weight of distance in the supervoxel clustering",
       &supervoxel.spatial_weight},
      {"supervoxel_normal_weight", "weight of normals in the supervoxel clustering",
       &supervoxel.normal_weight}};
}

bool
parseSlic(const std::string& text, SlicParameters& parameters)
{
  return parseSuperpixels(text, "slic", parameters);
}

bool
namesCloudCliques(const std::string& text)
{
  const std::string word = text.substr(0, text.find(':'));
  return word == "cubes" || word == "slic" || word == "supervoxel";
}

CliqueGenerator::Ptr
makeCliqueGenerator(const std::string& text, const CliqueParameters& parameters)
{
  SuperpixelParameters superpixel = parameters.superpixel;
  if (text == "cubes")
    return std::make_shared<CubeCliques>();
  if (text.rfind("cubes:", 0) == 0)
    return std::make_shared<CubeCliques>(numberAfterColon(text));
  if (parseSlic(text, superpixel.slic))
    return std::make_shared<SlicCliques>(superpixel.slic);
  if (parseSuperpixels(text, "superpixel", superpixel.slic))
    return std::make_shared<SuperpixelCliques>(superpixel);
  if (text == "supervoxel" || text.rfind("supervoxel:", 0) == 0) {
    SupervoxelParameters supervoxel = parameters.supervoxel;
    if (text != "supervoxel")
      supervoxel.seed_resolution = numberAfterColon(text);
    return std::make_shared<SupervoxelCliques>(supervoxel);
  }
  badParameter("cliques are '", text,
               "', expected cubes[:SIZE], slic, superpixel or "
               "supervoxel");
}

namespace {

ConfigParameters
cliqueParametersOf(SemanticCRFParameters& crf, const std::string& unit)
{
  return {
      {"clique_weight", "k_c, cost of a member whose label differs from its clique's",
       &crf.clique_weight},
      {"clique_free_label",
       "whether cliques have the free label, eq. (7): true or false", &crf.free_label},
      {"clique_truncation",
       "fraction of members that may differ before the free label is cheaper",
       &crf.clique_truncation},
      {"clique_update_from_members",
       "whether members update their clique, eq. (10): true or false",
       &crf.update_from_members, "clique_hears_members"},
      {"clique_map_messages",
       "whether a clique passes on its MAP label instead of its distribution: true "
       "or false",
       &crf.map_messages, "clique_members_hear_map"},
      {"clique_smoothness_weight",
       "weight of the kernel over the cliques' mean positions; 0 = off",
       &crf.clique_smoothness_weight},
      {"clique_smoothness_deviation", "its standard deviation [" + unit + "]",
       &crf.clique_smoothness_deviation},
      {"clique_appearance_weight",
       "weight of the kernel over the cliques' mean positions and colours; 0 = off",
       &crf.clique_appearance_weight},
      {"clique_appearance_deviation",
       "its standard deviation of positions [" + unit + "]",
       &crf.clique_appearance_deviation},
      {"clique_colour_deviation", "its standard deviation of colours [grey levels]",
       &crf.clique_colour_deviation}};
}

} // namespace

ConfigParameters
parametersOf(SemanticCRFParameters& crf, const std::string& unit)
{
  ConfigParameters parameters = {
      {"crf_iterations", "maximum number of mean-field updates", &crf.iterations},
      {"crf_tolerance", "stop when no probability changes by more than this; 0 = never",
       &crf.tolerance, "crf_settled"},
      {"crf_temperature",
       "temperature of the resulting probabilities: above 1 they are less sure, labels "
       "stay",
       &crf.temperature},
      {"crf_keep_thin",
       "whether what was measured as a class marked thin in the label set stays one "
       "unless much outvoted: true or false",
       &crf.keep_thin},
      {"crf_kernels",
       "evaluation of the kernels: automatic, truncated (exact within a radius) or "
       "lattice",
       chooseFrom(crf.kernel_method, {"automatic", "truncated", "lattice"})},
      {"crf_radius", "radius of truncated kernels [standard deviations]", &crf.radius},
      {"crf_normalization",
       "normalisation of the kernels: symmetric, one-sided or none",
       chooseFrom(crf.normalization, {"symmetric", "one-sided", "none"})},
      {"crf_self_interaction",
       "whether kernels include the point itself, as densecrf does: true or false",
       &crf.self_interaction},
      {"smoothness_weight", "weight of the smoothness kernel (positions)",
       &crf.smoothness_weight},
      {"smoothness_deviation",
       "its standard deviation [" + unit + "]; 0 = from the distance of the points",
       &crf.smoothness_deviation},
      {"appearance_weight",
       "weight of the appearance kernel (positions and colours; without colours "
       "positions alone)",
       &crf.appearance_weight},
      {"appearance_deviation",
       "its standard deviation of positions [" + unit +
           "]; 0 = from the distance of the points",
       &crf.appearance_deviation},
      {"colour_deviation", "its standard deviation of colours [grey levels]",
       &crf.colour_deviation}};
  append(parameters, cliqueParametersOf(crf, unit));
  return parameters;
}

void
CRFConfig::validate() const
{
  parameters.validate();
  requireConfidence(label_confidence);
}

void
CRFConfig::requireFittingCliques() const
{
  const bool needed =
      model == CRFModelType::pn_potts || model == CRFModelType::hierarchical;
  if (needed != (cliques != "none"))
    badParameter((needed ? "the models pn-potts and hierarchical need cliques: "
                         : "cliques are for the models pn-potts and "
                           "hierarchical, not with: "),
                 "--cliques ", cliques);
}

ConfigParameters
parametersOf(CRFConfig& config)
{
  ConfigParameters parameters = {
      {"crf", "unary, dense, pn-potts or hierarchical",
       chooseFrom(config.model, {"unary", "dense", "pn-potts", "hierarchical"})},
      {"cliques", config.clique_words, &config.cliques},
      {"label_confidence", "probability of the class that a label gives",
       &config.label_confidence}};
  append(parameters, parametersOf(config.parameters, config.unit));
  parameters.push_back(
      {"threads", "number of threads; 0 = all processors", &config.threads});
  return parameters;
}

void
readCRFConfig(const std::string& path, CRFConfig& config)
{
  readConfig(path, config);
}

namespace {

const std::vector<std::string> crf_models = {"none", "dense", "pn-potts",
                                             "hierarchical"};

// The number of a word among those that a value may be.
int
requireChoice(const char* name, const std::string& value,
              const std::vector<std::string>& words)
{
  const auto word = std::find(words.begin(), words.end(), value);
  if (word == words.end())
    badParameter(name, " is '", value, "', expected ", joinWords(words));
  return int(word - words.begin());
}

} // namespace

void
MapperConfig::validate()
{
  map.fusion.pixel_fusion =
      PixelFusion(requireChoice("pixel_fusion", pixel_fusion, {"mean", "product"}));
  map.fusion.clearing =
      Clearing(requireChoice("clearing", clearing, {"none", "full", "careful"}));
  requireChoice("crf", crf, crf_models);
  SlicParameters slic;
  if (parseSlic(cliques, slic)) // is for organized clouds
    badParameter("cliques are '", cliques,
                 "', expected cubes:SIZE, superpixel or supervoxel");
  makeCliqueGenerator(cliques, clique_parameters);
  if (!(map.max_range > 0.0))
    badParameter("max_depth is ", map.max_range, " m, expected more than 0");
  map.validate();
  crf_parameters.validate();
  makeDisparityEstimator(stereo, disparities); // checks both
  for (const auto& [name, value] : {std::pair("max_deviation", max_deviation),
                                    std::pair("deviation_scale", deviation_scale)})
    require(value >= 0.0 && value <= 100.0, name, value, "0 to 100");
  for (const auto& [name, value] :
       {std::pair("min_hit_ratio", min_hit_ratio),
        std::pair("clique_exclude_threshold", clique_exclude_threshold)})
    require(value >= 0.0 && value <= 1.0, name, value, "0 to 1");
  require(network_every >= 1, "network_every", network_every, "1 or more");
  require(crf_every >= 1, "crf_every", crf_every, "1 or more");
  requireConfidence(label_confidence);
}

ConfigParameters
parametersOf(MapperConfig& config)
{
  FusionParameters& fusion = config.map.fusion;
  ConfigParameters parameters = {
      {"stereo", "engine: " + joinWords(disparityEngines()), &config.stereo},
      {"disparities", "range of the disparity search, a multiple of 64 [px]",
       &config.disparities},
      {"max_deviation",
       "discard disparities whose standard deviation exceeds this [px]; 0 = keep all",
       &config.max_deviation},
      {"deviation_scale",
       "do not clear space within two standard deviations of a depth, times this; 0 = "
       "clear up to the depth",
       &config.deviation_scale},
      {"min_hit_ratio",
       "minimum fraction of the pixels whose rays reach a voxel that must hit it, "
       "against foreground fattening; 0 = off",
       &config.min_hit_ratio, "hit_share"},
      {"label_confidence", "probability of the class that a .png of --labels gives",
       &config.label_confidence},
      {"network_every",
       "use the labels of the first frame and of every N-th after it; the others bring "
       "depth and colour alone",
       &config.network_every},
      {"voxel_size", "edge of a voxel [m]", &config.map.voxel_size},
      {"window",
       "extent of the window around the sensor: X,Y,Z, world axes [m]; 0,0,0 = as far "
       "as max_depth reaches, at most 24 m high",
       &config.map.window},
      {"max_depth", "maximum depth of a hit [m]; pixels beyond it only clear space",
       &config.map.max_range},
      {"hit_probability", "probability of being occupied, given a hit",
       &fusion.hit_probability},
      {"miss_probability", "probability of being occupied, given a ray that passes",
       &fusion.miss_probability},
      {"min_probability", "lower bound of the occupancy probability",
       &fusion.min_probability},
      {"max_probability", "upper bound of the occupancy probability",
       &fusion.max_probability},
      {"occupied_probability", "a voxel is occupied at this probability or above",
       &fusion.occupied_probability},
      {"clearing",
       "what of a ray clears space: none of it, full, or careful: not its end, where "
       "it may run along the surface that it meets",
       &config.clearing},
      {"per_ray_counting",
       "count every ray instead of one hit or miss a frame, as in the paper: true or "
       "false",
       &fusion.per_ray_counting},
      {"dynamic_decay",
       "log-odds that voxels of dynamic classes lose per frame; 0 = off",
       &fusion.dynamic_decay},
      {"pixel_fusion", "fusion of the pixels of a frame in one voxel: mean or product",
       &config.pixel_fusion},
      {"label_min_probability", "lower bound of each measured class probability",
       &fusion.label_min_probability},
      {"label_max_ratio",
       "upper bound of largest / smallest probability of a fused distribution",
       &fusion.label_max_ratio},
      {"crf", "model: " + joinWords(crf_models), &config.crf},
      {"crf_every", "run the CRF at the first frame and every N-th after it",
       &config.crf_every},
      {"crf_write_back",
       "replace the measured distributions by those of the CRF: true or false",
       &config.crf_write_back},
      {"cliques",
       "cliques of pn-potts and hierarchical: cubes:SIZE [m], superpixel[:NUMBER] (of "
       "a frame) or supervoxel[:SEED_DISTANCE [m]]",
       &config.cliques},
      {"clique_exclude",
       "classes, separated by commas, whose voxels are in no clique, or none",
       &config.clique_exclude, "clique_leaves_out"},
      {"clique_exclude_threshold",
       "threshold on the probability of the classes of --clique-exclude",
       &config.clique_exclude_threshold, "clique_leaves_out_above"}};
  append(parameters, parametersOf(config.clique_parameters));
  append(parameters, parametersOf(config.crf_parameters, "m"));
  parameters.push_back(
      {"threads", "number of threads; 0 = all processors", &config.threads});
  return parameters;
}

std::vector<Label>
listedLabels(const std::string& names, const LabelSet& label_set,
             const std::string& what)
{
  std::vector<Label> labels;
  if (names == "none")
    return labels;
  for (const std::string_view name : splitAt(',', names)) {
    labels.push_back(label_set.find(std::string(name)));
    if (labels.back() == kUnlabelled)
      badParameter(what, ": class '", name, "' is not in the label set");
  }
  return labels;
}

void
readMapperConfig(const std::string& path, MapperConfig& config)
{
  readConfig(path, config);
}

CRFModelType
MapperConfig::crfModel() const
{
  return CRFModelType(requireChoice("crf", crf, crf_models));
}

std::string
printMapperConfig(const MapperConfig& config)
{
  MapperConfig copy = config;
  return printParameters(parametersOf(copy));
}

} // namespace pcl_semantic
