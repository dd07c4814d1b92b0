// SPDX-License-Identifier: BSD-3-Clause
#include "evaluated_classes.h"
#include "evaluated_folders.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/confusion_matrix.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/label_set_file.h>

#include <iostream>
#include <optional>

namespace {

using namespace pcl_semantic;

struct Options {
  std::vector<std::string> predictions;
  std::vector<std::string> truths;
  std::vector<std::string> covered_by;
  std::vector<std::string> truth_depths;
  std::vector<std::string> ranges;
  std::string label_set;
  std::string label_mapping;
  std::optional<std::string> ignore;
  std::string output;
  std::string row;
  bool header = false;
};

const tool::Usage usage{
    "pcl_semantic_evaluate", "--prediction DIR --truth DIR --label-set FILE [options]",
    "Compares label images, or labels of scans (.label), with ground truth of the\n"
    "same names and prints IoU, recall and precision in percent. Exclusive figures\n"
    "count the pixels that the prediction covers (is not 0); inclusive ones take\n"
    "uncovered pixels for misses. Folders may be given several times, in the same\n"
    "order: they are evaluated as one.",
    "pcl_semantic_evaluate --prediction /tmp/map/labels --truth /tmp/street/gt \\\n"
    "    --label-set data/label_sets/kitti11.yaml --output /tmp/evaluation"};

bool
parse(int argc, char** argv, Options& options)
{
  namespace po = tool::po;
  po::options_description description("Options");
  description.add_options()("prediction", po::value(&options.predictions)->required(),
                            "folder of predicted label images, or of scan labels")(
      "truth", po::value(&options.truths)->required(),
      "folder of ground truth, 0 = none; each file needs a prediction")(
      "covered-by", po::value(&options.covered_by),
      "folder of label images: count only pixels that are not 0 there")(
      "truth-depth", po::value(&options.truth_depths),
      "folder of the ground truth's depth, see pcl_semantic_lidar_truth")(
      "range", po::value(&options.ranges),
      "A:B = count only ground truth with depth A <= z < B [m]; repeat for several "
      "ranges")("label-set", po::value(&options.label_set)->required(),
                "classes (YAML)")("label-mapping", po::value(&options.label_mapping),
                                  "mapping from the ids of .label ground truth to "
                                  "classes (YAML), for SemanticKITTI")(
      "ignore", po::value<std::string>()->notifier([&](const std::string& words) {
        options.ignore = words;
      }),
      "classes not evaluated, as numbers or names separated by commas, or none "
      "(default: sky,pedestrian,cyclist, if in the label set)")(
      "output,o", po::value(&options.output),
      "output folder for metrics.json and confusion.csv")(
      "row", po::value(&options.row), "print a row of a Markdown table with this name")(
      "header", po::bool_switch(&options.header), "print the header of that table");
  po::variables_map values;
  if (!tool::parseCommandLine(argc, argv, usage, description, {}, values))
    return false;
  if (tool::manner().json && (options.header || !options.row.empty()))
    tool::failUsage(usage, "--json and a table in Markdown exclude each other");
  if (tool::manner().json && options.ranges.size() > 1)
    tool::failUsage(usage, "--json takes the figures of one --range");
  return true;
}

std::vector<tool::EvaluatedFolders>
foldersOf(const Options& options)
{
  const std::size_t count = options.truths.size();
  for (const auto& [name, folders] :
       {std::pair("--prediction", &options.predictions),
        std::pair("--covered-by", &options.covered_by),
        std::pair("--truth-depth", &options.truth_depths)})
    if (folders->size() != count && !folders->empty())
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "--truth and " << name << " are given " << count << " and "
                                         << folders->size()
                                         << " times, expected as many of each");
  if (options.ranges.empty() != options.truth_depths.empty())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "--range and --truth-depth belong together");
  if (options.ranges.size() > 1 && !options.output.empty())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "--output takes the figures of one --range, not of "
                            << options.ranges.size());
  std::vector<tool::EvaluatedFolders> all(count);
  for (std::size_t i = 0; i < count; ++i)
    all[i] = {options.predictions[i], options.truths[i],
              options.covered_by.empty() ? "" : options.covered_by[i],
              options.truth_depths.empty() ? "" : options.truth_depths[i]};
  return all;
}

void
report(const Options& options, const ConfusionMatrix& confusion,
       const LabelSet& label_set, const std::vector<Label>& evaluated,
       const std::string& range)
{
  const Scores scores = computeScores(confusion, evaluated);
  if (!options.output.empty()) {
    writeTextFile(options.output + "/metrics.json", scoresJson(scores, label_set));
    writeTextFile(options.output + "/confusion.csv",
                  confusionCsv(confusion, label_set));
  }
  if (!options.row.empty())
    std::cout << scoresMarkdownRow(scores, range.empty() ? options.row
                                                         : options.row + ", " + range);
  if (!options.header && options.row.empty())
    tool::printFigures((range.empty() ? "" : "\n" + range + "\n") +
                           scoresTable(scores, label_set),
                       scoresJson(scores, label_set));
}

int
evaluate(const Options& options)
{
  const std::vector<tool::EvaluatedFolders> folders = foldersOf(options);
  std::vector<tool::DepthRange> ranges;
  for (const std::string& range : options.ranges)
    ranges.push_back(tool::parseDepthRange(range));
  const LabelSet label_set = readLabelSet(options.label_set);
  std::optional<LabelMapping> mapping;
  if (!options.label_mapping.empty())
    mapping = readLabelMapping(options.label_mapping, label_set);
  const std::vector<Label> evaluated =
      tool::evaluatedClasses(options.ignore, label_set);
  if (!options.output.empty())
    makeOutputFolder(options.output);
  std::vector<ConfusionMatrix> total(std::max<std::size_t>(ranges.size(), 1),
                                     ConfusionMatrix(label_set.size()));
  for (const tool::EvaluatedFolders& each : folders) {
    const auto confusions =
        compareFolders(each, ranges, label_set, mapping ? &*mapping : nullptr);
    for (std::size_t i = 0; i < total.size(); ++i)
      total[i] += confusions[i];
  }
  if (options.header)
    std::cout << scoresMarkdownHeader(computeScores(total[0], evaluated), label_set);
  for (std::size_t i = 0; i < total.size(); ++i)
    report(options, total[i], label_set, evaluated,
           ranges.empty() ? "" : ranges[i].text);
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run(usage.name, [&] {
    Options options;
    return parse(argc, argv, options) ? evaluate(options) : int(tool::exit_done);
  });
}
