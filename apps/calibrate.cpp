// SPDX-License-Identifier: BSD-3-Clause
#include "files/report_text.h"
#include "image_tool.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/evaluation/confusion_matrix.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/labelling/calibration_fit.h>
#include <pcl_semantic/pipeline/calibration_trial.h>
#include <pcl_semantic/pipeline/mapper_config.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

const Usage usage{
    "pcl_semantic_calibrate",
    "SEQUENCE... --labels DIR --truth DIR --output DIR [options]",
    R"(Learns a calibration of a network's probabilities from sequences with ground truth,
by position and appearance of the points. Writes calibration.yaml for
pcl_semantic_map --label-calibration, without_NAME.yaml for each sequence, learned
only from the others, and report.md.)",
    R"(pcl_semantic_synthesize /tmp/one && pcl_semantic_synthesize /tmp/two --seed 2 && \
  pcl_semantic_calibrate /tmp/one /tmp/two --labels '{sequence}/labels' \
    --truth '{sequence}/gt' --output /tmp/calibrated)",
    {{"labels DIR", "label distributions; {sequence} = path, {name} = its last part"},
     {"truth DIR", "ground truth images; {sequence} and {name} as above"},
     {"output DIR", "folder of the calibrations and the report"},
     {"label-set FILE", "classes (default: label_sets/kitti11.yaml)"},
     {"clique-config FILE", "learn a calibration of cliques instead of labels"},
     {"features WORDS", "features with a curve, or none"},
     {"frames A:B", "frames with numbers A <= n < B"}}};

struct Arguments {
  std::vector<std::string> sequences;
  std::string labels, truth, label_set, output;
  std::string ground = "road,sidewalk";
  std::string clique_config, label_calibration, features;
  MapperConfig config;
  std::string frames = ":";
  CalibrationOptions fit;
};

// Fills in a path pattern of several sequences: {sequence} is replaced by the path of
// the sequence, {name} by its last component.
std::string
filledIn(const std::string& pattern, const std::string& sequence)
{
  const std::string name =
      (std::filesystem::path(sequence) / "").parent_path().filename().string();
  std::string filled;
  for (std::size_t at = 0; at < pattern.size();) {
    const bool is_path = pattern.compare(at, 10, "{sequence}") == 0;
    const bool is_name = pattern.compare(at, 6, "{name}") == 0;
    filled += is_path ? sequence : is_name ? name : pattern.substr(at, 1);
    at += is_path ? 10 : is_name ? 6 : 1;
  }
  return filled;
}

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
  for (const std::string& name : splitAtCommas(names == "none" ? "" : names)) {
    const std::optional<Feature> feature = findFeature(name);
    refuseIf(!feature, "--features: '" + name + "' is no feature");
    refuseIf(!of_cliques && (feature == Feature::lowest || feature == Feature::extent),
             "--features: '" + name + "' is only for cliques, with --clique-config");
    features.push_back(*feature);
  }
  return features;
}

// Parameters of a map that are also used without one.
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

// Reads the parameters of the maps; options override the file.
void
readCliqueConfig(const po::variables_map& values, Arguments& options)
{
  readMapperConfig(options.clique_config, options.config);
  if (!options.clique_config.empty() &&
      options.config.crf != CRFModelType::hierarchical)
    fail<BadInputException>(options.clique_config, ": crf is ",
                            nameOf(options.config.crf), ", expected hierarchical");
  if (options.config.network_every != 1)
    fail<BadInputException>(
        options.clique_config, ": network_every is ", options.config.network_every,
        ", expected 1: cliques are learned from the labels of every "
        "frame");
  refuseIf(options.clique_config.empty() && !options.label_calibration.empty(),
           "--label-calibration is for maps, with --clique-config");
  setParameters(values, parametersWithoutMap(options.config));
}

void
setFeatures(Arguments& options)
{
  const bool of_cliques = !options.clique_config.empty();
  if (options.features.empty())
    options.features = namesOf(of_cliques ? cliqueFeatures() : pixelFeatures());
  options.fit.curves = streetKnots(featuresOf(options.features, of_cliques));
}

Arguments
parse(int argc, char** argv)
{
  Arguments options;
  const po::variables_map values = parseCommandLine(
      argc, argv, usage,
      {{"sequences", required(options.sequences),
        "folders in KITTI's odometry layout, with poses.txt"},
       {"labels", required(options.labels),
        "folder of the label distributions of each sequence; {sequence} = path of the "
        "sequence, {name} = last part of the path"},
       {"truth", required(options.truth),
        "folder of the ground truth images of each sequence; {sequence} and {name} as "
        "in --labels"},
       {"output,o", required(options.output), "output folder"},
       {"label-set", options.label_set, "classes (default: label_sets/kitti11.yaml)"},
       {"clique-config", options.clique_config,
        "configuration of pcl_semantic_map (.yaml, options override it): learn a "
        "calibration of the cliques in its maps, for --clique-calibration, instead of "
        "one of labels"},
       {"label-calibration", options.label_calibration,
        "label calibration of the maps with --clique-config (.yaml); {sequence} and "
        "{name} as in --labels"},
       {"features", options.features,
        "features with a curve, separated by commas, or none: height, distance, level, "
        "side, brightness, red, green; for cliques also lowest, extent (default: " +
            namesOf(pixelFeatures()) + "; for cliques " + namesOf(cliqueFeatures()) +
            ")"},
       {"ground", withDefault(options.ground),
        "ground classes, separated by commas, or none"},
       {"frames", withDefault(options.frames),
        "A:B = frames of each sequence with numbers A <= n < B; : = all"},
       {"balance", withDefault(options.fit.balance),
        "weighting within a sequence: 0 = equal weight of all pixels, 1 = equal weight "
        "of all classes"},
       {"shrinkage", withDefault(options.fit.shrinkage),
        "fraction subtracted from biases and curves after the fit, 0 to 1, because a "
        "new street resembles these sequences only partly"},
       {"bias-penalty", withDefault(options.fit.bias_penalty),
        "penalty weight of the squared bias of a class"},
       {"curve-penalty", withDefault(options.fit.curve_penalty),
        "penalty weight of the squared values of the curves"}},
      {"sequences..."}, parametersWithoutMap(options.config));
  readCliqueConfig(values, options);
  setFeatures(options);
  options.config.validate();
  options.fit.validate();
  return options;
}

std::string
report(const CalibrationTrial& trial, const Arguments& options,
       const LabelSet& label_set)
{
  const std::vector<Label> classes = evaluatedClasses(std::nullopt, label_set);
  const Scores network = computeScores(trial.network, classes);
  std::string text =
      (options.clique_config.empty()
           ? "# Pixels with ground truth, before any map"
           : "# Pixels with ground truth, by the clique of their voxel") +
      ("\n\nFeatures: " + options.features + "\n\n") +
      scoresMarkdownHeader(network, label_set) +
      scoresMarkdownRow(network, options.clique_config.empty()
                                     ? "the network as it comes"
                                     : "the mean of the clique's members");
  text += scoresMarkdownRow(computeScores(trial.fitted, classes),
                            "calibrated, learned from all");
  if (!trial.without.empty())
    text += scoresMarkdownRow(computeScores(trial.held_out, classes),
                              "calibrated, learned from the others");
  return text;
}

std::string
jsonOf(const CalibrationTrial& trial, const LabelSet& label_set)
{
  const std::vector<Label> classes = evaluatedClasses(std::nullopt, label_set);
  const auto scores = [&](const ConfusionMatrix& confusion) {
    return nlohmann::ordered_json::parse(
        scoresJson(computeScores(confusion, classes), label_set));
  };
  nlohmann::ordered_json json = {{"network", scores(trial.network)},
                                 {"learned_from_all", scores(trial.fitted)}};
  if (!trial.without.empty())
    json["learned_from_the_others"] = scores(trial.held_out);
  return jsonText(json);
}

// Removes the calibrations of an earlier run, which would look like results of this
// one.
void
removeEarlier(const std::string& output)
{
  for (const auto& entry : std::filesystem::directory_iterator(output))
    if (entry.path().filename().string().rfind("without_", 0) == 0 &&
        entry.path().extension() == ".yaml")
      std::filesystem::remove(entry.path());
}

int
calibrateSequences(const Arguments& options)
{
  setNumberOfThreads(options.config.threads);
  const LabelSet label_set = readLabelSetOrDefault(options.label_set);
  const std::vector<Label> ground = listedLabels(options.ground, label_set, "--ground");
  std::vector<CalibrationSamples> samples;
  std::vector<std::string> names;
  {
    ProgressBar progress("reading", options.sequences.size(), "sequences");
    for (const std::string& folder : options.sequences) {
      const CalibrationSequence sequence({folder, filledIn(options.labels, folder),
                                          filledIn(options.truth, folder),
                                          filledIn(options.label_calibration, folder),
                                          parseFrameRange(options.frames)},
                                         label_set.size());
      warnOf(sequence.doubts());
      refuseIf(std::count(names.begin(), names.end(), sequence.name()),
               "two sequences have the name " + sequence.name() +
                   ", expected different names");
      names.push_back(sequence.name());
      samples.push_back(
          options.clique_config.empty()
              ? calibrationSamples(sequence, options.config, ground, options.fit.curves)
              : cliqueSamples(sequence, options.config, label_set, ground));
      progress.step();
    }
  }
  makeOutputFolder(options.output);
  const CalibrationTrial trial = tryCalibration(samples, ground, options.fit);
  removeEarlier(options.output);
  const std::string path = options.output + "/";
  writeTextFile(path + "calibration.yaml", printCalibration(trial.all, label_set));
  for (std::size_t s = 0; s < trial.without.size(); ++s)
    writeTextFile(path + "without_" + names[s] + ".yaml",
                  printCalibration(trial.without[s], label_set));
  const std::string text = report(trial, options, label_set);
  writeTextFile(path + "report.md", text);
  printFigures(text + "\ncalibration: " + path + "calibration.yaml\n",
               jsonOf(trial, label_set));
  return exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return runWithImages(usage.name,
                       [&] { return calibrateSequences(parse(argc, argv)); });
}
