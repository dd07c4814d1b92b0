// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate_arguments.h"
#include "parameter_options.h"

#include <pcl_semantic/core/exceptions.h>

#include <sstream>

namespace pcl_semantic::tool {

const Usage calibrate_usage{
    "pcl_semantic_calibrate",
    "SEQUENCE... --labels DIR --truth DIR --output DIR [options]",
    "Learns from sequences with truth what a network's probabilities are worth, given\n"
    "where a point is and how it looks. Writes calibration.yaml for pcl_semantic_map\n"
    "--label-calibration; for each sequence without_NAME.yaml, learned from the "
    "others\n"
    "alone; and report.md.",
    "pcl_semantic_synthesize /tmp/one && pcl_semantic_synthesize /tmp/two --seed 2 && "
    "\\\n"
    "  pcl_semantic_calibrate /tmp/one /tmp/two --labels '{sequence}/labels' \\\n"
    "    --truth '{sequence}/gt' --output /tmp/calibrated"};

namespace {

std::string
namesOf(const std::vector<Feature>& features)
{
  std::string names;
  for (const Feature feature : features)
    names += std::string(names.empty() ? "" : ",") + nameOf(feature);
  return names;
}

std::vector<Feature>
featuresOf(const std::string& names, bool of_cliques)
{
  std::vector<Feature> features;
  std::istringstream stream(names == "none" ? "" : names);
  for (std::string name; std::getline(stream, name, ',');) {
    const std::optional<Feature> feature = findFeature(name);
    if (!feature)
      failUsage(calibrate_usage, "--features: '" + name + "' is none");
    if (!of_cliques && (feature == Feature::lowest || feature == Feature::extent))
      failUsage(calibrate_usage, "--features: '" + name + "' is not known of pixels");
    features.push_back(*feature);
  }
  return features;
}

// Those of a map's parameters that also matter without one.
ConfigParameters
parametersWithoutMap(MapperConfig& config)
{
  ConfigParameters parameters;
  for (const ConfigParameter& parameter : parametersOf(config))
    for (const char* const name :
         {"stereo", "disparities", "max_deviation", "label_confidence", "threads"})
      if (parameter.name == name)
        parameters.push_back(parameter);
  return parameters;
}

// The parameters of the maps: options override the file.
void
readCliqueConfig(const po::variables_map& values, CalibrateArguments& options)
{
  readMapperConfig(options.clique_config, options.config);
  if (!options.clique_config.empty() && options.config.crf != "hierarchical")
    PCL_THROW_EXCEPTION(BadInputException, options.clique_config
                                               << ": crf is " << options.config.crf
                                               << ", expected hierarchical");
  if (options.clique_config.empty() && !options.label_calibration.empty())
    failUsage(calibrate_usage, "--label-calibration is for maps, with --clique-config");
  setParameters(values, parametersWithoutMap(options.config));
}

void
setFeatures(CalibrateArguments& options)
{
  const bool of_cliques = !options.clique_config.empty();
  if (options.features.empty())
    options.features = namesOf(of_cliques ? cliqueFeatures() : pixelFeatures());
  options.fit.curves = streetKnots(featuresOf(options.features, of_cliques));
}

void
addOptions(CalibrateArguments& options, po::options_description& description)
{
  description.add_options()("sequences", po::value(&options.sequences)->required(),
                            "folders in KITTI's odometry layout, with poses.txt")(
      "labels", po::value(&options.labels)->required(),
      "folder of each sequence's label distributions; {sequence} stands for its path, "
      "{name} for the last part of it")(
      "truth", po::value(&options.truth)->required(),
      "folder of each sequence's truth images, likewise")(
      "output,o", po::value(&options.output)->required(),
      "folder to write to")("label-set", po::value(&options.label_set),
                            "classes (default: label_sets/kitti11.yaml)");
  description.add_options()(
      "clique-config", po::value(&options.clique_config),
      "learns what cliques are worth instead, of maps with this configuration of "
      "pcl_semantic_map (.yaml, options override it): for its --clique-calibration")(
      "label-calibration", po::value(&options.label_calibration),
      "of the labels in these maps; {sequence} and {name} as above");
  description.add_options()(
      "features", po::value(&options.features),
      ("what curves are over: none, or some of height,distance,level,side,brightness,"
       "red,green, of cliques also lowest,extent (default: " +
       namesOf(pixelFeatures()) + "; of cliques " + namesOf(cliqueFeatures()) + ")")
          .c_str());
  addOption(description, "ground", options.ground,
            "classes that the ground is made of, or none");
  addOption(description, "frames", options.frames,
            "A:B, frames numbered A <= n < B, of each sequence");
  addOption(description, "balance", options.fit.balance,
            "0 = every pixel counts alike, 1 = every class");
  addOption(description, "bias-penalty", options.fit.bias_penalty,
            "on the square of a class's bias");
  addOption(description, "curve-penalty", options.fit.curve_penalty,
            "on the squares of the curves' values");
  addParameters(parametersWithoutMap(options.config), description);
}

} // namespace

bool
parseArguments(int argc, char** argv, CalibrateArguments& options)
{
  po::options_description description("Options");
  addOptions(options, description);
  po::positional_options_description positional;
  positional.add("sequences", -1);
  po::variables_map values;
  if (!parseCommandLine(argc, argv, calibrate_usage, description, positional, values))
    return false;
  readCliqueConfig(values, options);
  setFeatures(options);
  options.config.validate();
  options.fit.validate();
  return true;
}

} // namespace pcl_semantic::tool
