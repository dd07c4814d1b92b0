// SPDX-License-Identifier: BSD-3-Clause
#include "default_label_set.h"
#include "messages.h"
#include "progress_bar.h"
#include "sequence_pattern.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/pipeline/tuning_report.h>
#include <pcl_semantic/pipeline/tuning_runner.h>

#include <algorithm>
#include <filesystem>
#include <thread>

namespace {

using namespace pcl_semantic;
namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> sequences;
  std::string grid, start, labels, truth, label_set, output, runs, calibration;
  std::string method = "coordinate", score = "exclusive", view = "both";
  std::string frames = ":";
  double memory = 6.0; // [GB]
  TuningOptions tuning;
};

const tool::Usage usage{
    "pcl_semantic_tune",
    "SEQUENCE... --config GRID.yaml --labels DIR --truth DIR --output DIR [options]",
    "Searches the parameters of pcl_semantic_map that do best on sequences with "
    "truth.\n"
    "GRID.yaml has the keys of --config, each with a value or a list of candidates.\n"
    "Every sequence is also scored with what a search on the others alone chooses, so\n"
    "that a gain on the training sequences alone is seen. Writes best.yaml, "
    "report.md,\n"
    "table.tsv and sensitivity.png.",
    "pcl_semantic_synthesize /tmp/one && pcl_semantic_synthesize /tmp/two --seed 2 && "
    "\\\n"
    "  echo 'smoothness_weight: [1, 3]' > /tmp/grid.yaml && \\\n"
    "  pcl_semantic_tune /tmp/one /tmp/two --config /tmp/grid.yaml \\\n"
    "    --labels '{sequence}/labels' --truth '{sequence}/gt' --output /tmp/tuned"};

int
wordOf(const std::string& option, const std::string& word,
       const std::vector<std::string>& words)
{
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end())
    tool::failUsage(usage,
                    "--" + option + " is '" + word + "', expected " + joinWords(words));
  return int(found - words.begin());
}

bool
parse(int argc, char** argv, Options& options)
{
  namespace po = tool::po;
  po::options_description description("Options");
  TuningOptions& tuning = options.tuning;
  tuning.workers = int(std::max(1u, std::thread::hardware_concurrency()));
  description.add_options()("sequences", po::value(&options.sequences)->required(),
                            "folders in KITTI's odometry layout, with poses.txt")(
      "config", po::value(&options.grid)->required(), "what is searched (YAML)")(
      "labels", po::value(&options.labels)->required(),
      "folder of each sequence's label distributions; {sequence} stands for its path, "
      "{name} for the last part of it")(
      "truth", po::value(&options.truth)->required(),
      "folder of each sequence's truth images, likewise")(
      "label-calibration", po::value(&options.calibration),
      "calibration of each sequence's labels, likewise (default: none)")(
      "output,o", po::value(&options.output)->required(),
      "folder to write to")("start", po::value(&options.start),
                            "parameters to begin with (YAML, default: the defaults)")(
      "label-set", po::value(&options.label_set),
      "classes (default: label_sets/kitti11.yaml)")(
      "runs", po::value(&options.runs),
      "file that keeps every run, to go on with (default: runs.jsonl in --output)");
  tool::addOption(description, "frames", options.frames,
                  "A:B, frames numbered A <= n < B, of each sequence");
  tool::addOption(description, "search", options.method,
                  "coordinate: one parameter after the other until none gets better; "
                  "grid: everything; random");
  tool::addOption(description, "budget", tuning.search.budget,
                  "configurations a search may look at");
  tool::addOption(description, "least-gain", tuning.search.least_gain,
                  "points below which --search coordinate does not move a parameter");
  tool::addOption(description, "seed", tuning.search.seed, "of --search random");
  tool::addOption(description, "score", options.score,
                  "mean IoU: exclusive, inclusive, or gain (exclusive, above that of "
                  "the network on the same pixels)");
  tool::addOption(description, "view", options.view, "both, depth or rendered");
  tool::addOption(description, "margin", tuning.margin,
                  "of the configurations so many points below the best, the one that "
                  "changes the least is chosen");
  tool::addOption(description, "workers", tuning.workers, "runs at a time");
  tool::addOption(description, "memory", options.memory, "for mapped frames [GB]");
  po::positional_options_description positional;
  positional.add("sequences", -1);
  po::variables_map values;
  if (!tool::parseCommandLine(argc, argv, usage, description, positional, values))
    return false;
  tuning.search.method =
      TuningMethod(wordOf("search", options.method, {"coordinate", "grid", "random"}));
  tuning.score.kind = TuningScore::Kind(
      wordOf("score", options.score, {"exclusive", "inclusive", "gain"}));
  tuning.score.view =
      TuningScore::View(wordOf("view", options.view, {"both", "depth", "rendered"}));
  if (!(options.memory >= 0.0 && options.memory < 1e6))
    tool::failUsage(usage, "--memory is " + tool::shown(options.memory) +
                               ", expected 0 or more");
  return true;
}

int
tune(const Options& options)
{
  MapperConfig start;
  readMapperConfig(options.start, start);
  const LabelSet label_set = tool::readLabelSetOrDefault(options.label_set);
  const TuningGrid grid = readTuningGrid(options.grid, start, label_set);
  std::vector<std::shared_ptr<const TuningSequence>> sequences;
  std::vector<std::string> names;
  for (const std::string& folder : options.sequences) {
    sequences.push_back(std::make_shared<TuningSequence>(
        TuningFolders{folder, tool::filledIn(options.labels, folder),
                      tool::filledIn(options.truth, folder),
                      tool::filledIn(options.calibration, folder),
                      parseFrameRange(options.frames)},
        label_set.size()));
    names.push_back(sequences.back()->name());
  }
  TuningOptions tuning = options.tuning;
  tuning.score.classes = classesThatCount(label_set);
  Tuner::require(grid, names, tuning);
  makeOutputFolder(options.output);
  const std::string data = describeTuning(sequences);
  TuningStore store(options.runs.empty() ? options.output + "/runs.jsonl"
                                         : options.runs,
                    data, label_set.size());
  TuningRunner runner(sequences, label_set, std::size_t(options.memory * 1e9));
  Tuner tuner(
      grid, names, label_set.size(),
      [&](const MapperConfig& config, std::size_t i) { return runner.run(config, i); },
      store, tuning);
  std::unique_ptr<tool::ProgressBar> progress;
  tuner.on_progress = [&](std::size_t done, std::size_t total) {
    if (done == 0)
      progress = std::make_unique<tool::ProgressBar>("tuning", total, "runs");
    else
      progress->step();
  };
  tool::catchInterrupts();
  tuner.is_stopped = tool::interrupted;
  const bool finished = tuner.search();
  progress.reset();
  if (!finished)
    return tool::exit_interrupted;
  writeTuning(options.output, tuner, label_set, data);
  const auto scoreOf = [&](const TuningResult& result) { return tuning.score(result); };
  tool::printFigures({{"new_runs", tuner.runs()},
                      {"known_runs", store.known()},
                      {"score_at_start", scoreOf(tuner.pooled(grid.startChoice()))},
                      {"score_chosen", scoreOf(tuner.pooled(tuner.chosen()))},
                      {"score_held_out", scoreOf(tuner.heldOut())},
                      {"config", options.output + "/best.yaml"},
                      {"report", options.output + "/report.md"}});
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run(usage.name, [&] {
    Options options;
    return parse(argc, argv, options) ? tune(options) : int(tool::exit_done);
  });
}
