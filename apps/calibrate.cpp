/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "default_label_set.h"
#include "parameter_options.h"
#include "progress_bar.h"
#include "sequence_pattern.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/evaluation/evaluation_report.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/pipeline/calibration_trial.h>
#include <pcl_semantic/pipeline/tuning_score.h>

#include <iostream>
#include <sstream>

namespace {

using namespace pcl_semantic;

struct Options {
  std::vector<std::string> sequences;
  std::string labels, truth, label_set, output;
  std::string ground = "road,sidewalk";
  MapperConfig config;
  CalibrationOptions fit;
  int threads = 0;
};

const tool::Usage usage{
    "pcl_semantic_calibrate",
    "SEQUENCE... --labels DIR --truth DIR --output DIR [options]",
    "Learns from sequences with truth what a network's probabilities are worth, given\n"
    "the height above the ground, the distance and the levelness of a point. Writes\n"
    "calibration.yaml for pcl_semantic_map --label-calibration; for each sequence\n"
    "without_NAME.yaml, learned from the others alone; and report.md.",
    "pcl_semantic_synthesize /tmp/one && pcl_semantic_synthesize /tmp/two --seed 2 && "
    "\\\n"
    "  pcl_semantic_calibrate /tmp/one /tmp/two --labels '{sequence}/labels' \\\n"
    "    --truth '{sequence}/gt' --output /tmp/calibrated"};

bool
parse(int argc, char** argv, Options& options)
{
  namespace po = tool::po;
  po::options_description description("Options");
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
  tool::addOption(description, "ground", options.ground,
                  "classes that the ground is made of");
  tool::addOption(description, "stereo", options.config.stereo,
                  "engine, as of pcl_semantic_map");
  tool::addOption(description, "max-deviation", options.config.max_deviation,
                  "as of pcl_semantic_map [px]");
  tool::addOption(description, "label-confidence", options.config.label_confidence,
                  "as of pcl_semantic_map");
  tool::addOption(description, "balance", options.fit.balance,
                  "0 = every pixel counts alike, 1 = every class");
  tool::addOption(description, "bias-penalty", options.fit.bias_penalty,
                  "on the square of a class's bias");
  tool::addOption(description, "curve-penalty", options.fit.curve_penalty,
                  "on the squares of the curves' values");
  tool::addOption(description, "threads", options.threads, "0 = all processors");
  po::positional_options_description positional;
  positional.add("sequences", -1);
  po::variables_map values;
  if (!tool::parseCommandLine(argc, argv, usage, description, positional, values))
    return false;
  options.config.validate();
  options.fit.validate();
  return true;
}

std::vector<Label>
groundLabels(const std::string& names, const LabelSet& label_set)
{
  std::vector<Label> labels;
  std::istringstream stream(names);
  for (std::string name; std::getline(stream, name, ',');) {
    const Label label = label_set.find(name);
    if (label == kUnlabelled)
      tool::failUsage(usage, "--ground: class '" + name + "' is not in the label set");
    labels.push_back(label);
  }
  return labels;
}

std::string
report(const CalibrationTrial& trial, const LabelSet& label_set)
{
  const std::vector<Label> classes = classesThatCount(label_set);
  const Scores network = computeScores(trial.network, classes);
  std::string text = "# Pixels with truth, before any map\n\n" +
                     scoresMarkdownHeader(network, label_set) +
                     scoresMarkdownRow(network, "the network as it comes");
  text += scoresMarkdownRow(computeScores(trial.fitted, classes),
                            "calibrated, learned from all");
  if (!trial.without.empty())
    text += scoresMarkdownRow(computeScores(trial.held_out, classes),
                              "calibrated, learned from the others");
  return text;
}

int
calibrateSequences(const Options& options)
{
  setNumberOfThreads(options.threads);
  const LabelSet label_set = tool::readLabelSetOrDefault(options.label_set);
  const std::vector<Label> ground = groundLabels(options.ground, label_set);
  std::vector<CalibrationSamples> samples;
  std::vector<std::string> names;
  {
    tool::ProgressBar progress("reading", options.sequences.size(), "sequences");
    for (const std::string& folder : options.sequences) {
      const TuningSequence sequence({folder, tool::filledIn(options.labels, folder),
                                     tool::filledIn(options.truth, folder), ""},
                                    label_set.size());
      if (std::count(names.begin(), names.end(), sequence.name()))
        tool::failUsage(usage, "two sequences are called " + sequence.name());
      names.push_back(sequence.name());
      samples.push_back(calibrationSamples(sequence, options.config, ground));
      progress.step();
    }
  }
  makeOutputFolder(options.output);
  const CalibrationTrial trial = tryCalibration(samples, ground, options.fit);
  const std::string path = options.output + "/";
  writeTextFile(path + "calibration.yaml", printCalibration(trial.all, label_set));
  for (std::size_t s = 0; s < trial.without.size(); ++s)
    writeTextFile(path + "without_" + names[s] + ".yaml",
                  printCalibration(trial.without[s], label_set));
  const std::string text = report(trial, label_set);
  writeTextFile(path + "report.md", text);
  std::cout << text << "\ncalibration: " << path << "calibration.yaml\n";
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run(usage.name, [&] {
    Options options;
    return parse(argc, argv, options) ? calibrateSequences(options)
                                      : int(tool::exit_done);
  });
}
