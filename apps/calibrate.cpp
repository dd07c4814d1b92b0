// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate_arguments.h"
#include "default_label_set.h"
#include "evaluated_classes.h"
#include "messages.h"
#include "progress_bar.h"
#include "sequence_pattern.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/evaluation/confusion_matrix.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/pipeline/calibration_trial.h>
#include <pcl_semantic/pipeline/listed_labels.h>

#include <nlohmann/json.hpp>

#include <filesystem>

namespace {

using namespace pcl_semantic;

std::string
report(const CalibrationTrial& trial, const tool::CalibrateArguments& options,
       const LabelSet& label_set)
{
  const std::vector<Label> classes = tool::evaluatedClasses(std::nullopt, label_set);
  const Scores network = computeScores(trial.network, classes);
  std::string text =
      (options.clique_config.empty()
           ? "# Pixels with truth, before any map"
           : "# Pixels with truth, by the clique of their voxel") +
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
  const std::vector<Label> classes = tool::evaluatedClasses(std::nullopt, label_set);
  const auto scores = [&](const ConfusionMatrix& confusion) {
    return nlohmann::ordered_json::parse(
        scoresJson(computeScores(confusion, classes), label_set));
  };
  nlohmann::ordered_json json = {{"network", scores(trial.network)},
                                 {"learned_from_all", scores(trial.fitted)}};
  if (!trial.without.empty())
    json["learned_from_the_others"] = scores(trial.held_out);
  return json.dump(2) + "\n";
}

// What an earlier run has learned from other sequences would be taken for ours.
void
removeEarlier(const std::string& output)
{
  for (const auto& entry : std::filesystem::directory_iterator(output))
    if (entry.path().filename().string().rfind("without_", 0) == 0 &&
        entry.path().extension() == ".yaml")
      std::filesystem::remove(entry.path());
}

int
calibrateSequences(const tool::CalibrateArguments& options)
{
  setNumberOfThreads(options.config.threads);
  const LabelSet label_set = tool::readLabelSetOrDefault(options.label_set);
  const std::vector<Label> ground = listedLabels(options.ground, label_set, "--ground");
  std::vector<CalibrationSamples> samples;
  std::vector<std::string> names;
  {
    tool::ProgressBar progress("reading", options.sequences.size(), "sequences");
    for (const std::string& folder : options.sequences) {
      const CalibrationSequence sequence(
          {folder, tool::filledIn(options.labels, folder),
           tool::filledIn(options.truth, folder),
           tool::filledIn(options.label_calibration, folder),
           parseFrameRange(options.frames)},
          label_set.size());
      if (std::count(names.begin(), names.end(), sequence.name()))
        tool::failUsage(tool::calibrate_usage,
                        "two sequences are called " + sequence.name());
      names.push_back(sequence.name());
      samples.push_back(
          options.clique_config.empty()
              ? calibrationSamples(sequence, options.config, ground)
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
  tool::printFigures(text + "\ncalibration: " + path + "calibration.yaml\n",
                     jsonOf(trial, label_set));
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run(tool::calibrate_usage.name, [&] {
    tool::CalibrateArguments options;
    return tool::parseArguments(argc, argv, options) ? calibrateSequences(options)
                                                     : int(tool::exit_done);
  });
}
