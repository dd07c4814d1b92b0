/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/evaluation_report.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/label_set_file.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <iostream>
#include <sstream>

namespace {

using namespace pcl_semantic;

struct Options {
  std::vector<std::string> predictions;
  std::vector<std::string> truths;
  std::vector<std::string> covered_by;
  std::string label_set;
  std::string ignore;
  bool ignore_given = false;
  std::string output;
  std::string row;
  bool header = false;
};

const tool::Usage usage{
    "pcl_semantic_evaluate", "--prediction DIR --truth DIR --label-set FILE [options]",
    "Compares label images with truth images of the same names and prints IoU, recall\n"
    "and precision in percent. Exclusive figures count the pixels that the prediction\n"
    "covers (is not 0); inclusive ones take uncovered pixels for misses. Folders may "
    "be\n"
    "given several times, in the same order: they are evaluated as one.",
    "pcl_semantic_evaluate --prediction /tmp/map/labels --truth /tmp/street/gt \\\n"
    "    --label-set data/label_sets/kitti11.yaml --output /tmp/evaluation"};

bool
parse(int argc, char** argv, Options& options)
{
  namespace po = tool::po;
  po::options_description description("Options");
  description.add_options()("prediction", po::value(&options.predictions)->required(),
                            "folder of label images")(
      "truth", po::value(&options.truths)->required(),
      "folder of truth images, 0 = no truth; each needs a prediction")(
      "covered-by", po::value(&options.covered_by),
      "folder of images: count only pixels where the one of the same name is not 0")(
      "label-set", po::value(&options.label_set)->required(), "classes (YAML)")(
      "ignore", po::value(&options.ignore),
      "classes whose truth does not count, numbers or names with commas between them, "
      "or "
      "none; default: sky,pedestrian,cyclist, as far as the label set has them")(
      "output,o", po::value(&options.output),
      "folder for metrics.json, confusion.csv and confusion.png")(
      "row", po::value(&options.row), "print one row of a Markdown table of this name")(
      "header", po::bool_switch(&options.header), "print the header of such a table");
  po::variables_map values;
  if (!tool::parseCommandLine(argc, argv, usage, description, {}, values))
    return false;
  options.ignore_given = values.count("ignore") > 0;
  return true;
}

/** \brief The class that a number or a name of --ignore means. */
Label
ignoredLabel(const std::string& word, const LabelSet& label_set)
{
  int number = 0;
  const auto [rest, error] =
      std::from_chars(word.data(), word.data() + word.size(), number);
  if (error == std::errc() && rest == word.data() + word.size()) {
    if (number >= 1 && number <= label_set.size())
      return static_cast<Label>(number);
  }
  else if (const Label label = label_set.find(word))
    return label;
  PCL_THROW_EXCEPTION(InvalidParameterException,
                      "--ignore: '" << word << "' is no class of the label set");
}

std::vector<Label>
evaluatedClasses(const Options& options, const LabelSet& label_set)
{
  std::vector<Label> ignored;
  if (!options.ignore_given)
    ignored = {label_set.find("sky"), label_set.find("pedestrian"),
               label_set.find("cyclist")};
  else if (options.ignore != "none") {
    std::istringstream words(options.ignore);
    for (std::string word; std::getline(words, word, ',');)
      ignored.push_back(ignoredLabel(word, label_set));
  }
  std::vector<Label> evaluated;
  for (int label = 1; label <= label_set.size(); ++label)
    if (std::find(ignored.begin(), ignored.end(), label) == ignored.end())
      evaluated.push_back(static_cast<Label>(label));
  if (evaluated.empty())
    PCL_THROW_EXCEPTION(InvalidParameterException, "--ignore leaves no class");
  return evaluated;
}

ConfusionMatrix
compareFolders(const std::string& prediction, const std::string& truth,
               const std::string& covered_by, const LabelSet& label_set)
{
  const std::vector<FrameFile> files = listFrameFiles(truth, {".png"});
  if (files.empty())
    PCL_THROW_EXCEPTION(BadInputException,
                        truth << ": holds no truth images, expected 000000.png ...");
  ConfusionMatrix confusion(label_set.size());
  for (const FrameFile& file : files) {
    const std::string name = "/" + std::filesystem::path(file.path).filename().string();
    if (!std::filesystem::exists(prediction + name))
      PCL_THROW_EXCEPTION(BadInputException,
                          prediction << name << ": is missing, expected as the "
                                     << "prediction for " << file.path);
    const cv::Mat truth_image = readPng(file.path, ImageKind::labels);
    const cv::Mat prediction_image = readPng(prediction + name, ImageKind::labels);
    const cv::Mat covered_image =
        covered_by.empty() ? cv::Mat() : readPng(covered_by + name, ImageKind::labels);
    try {
      confusion.add(truth_image, prediction_image, covered_image);
    }
    catch (const BadInputException& error) {
      PCL_THROW_EXCEPTION(BadInputException, prediction << name << " against "
                                                        << file.path << ": "
                                                        << error.what());
    }
  }
  return confusion;
}

int
evaluate(const Options& options)
{
  const std::size_t count = options.truths.size();
  if (options.predictions.size() != count ||
      (!options.covered_by.empty() && options.covered_by.size() != count))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "--prediction, --truth and --covered-by are given "
                            << options.predictions.size() << ", " << count << " and "
                            << options.covered_by.size()
                            << " times, expected as many of each");
  const LabelSet label_set = readLabelSet(options.label_set);
  const std::vector<Label> evaluated = evaluatedClasses(options, label_set);
  if (!options.output.empty())
    makeOutputFolder(options.output);
  ConfusionMatrix confusion(label_set.size());
  for (std::size_t i = 0; i < count; ++i)
    confusion += compareFolders(options.predictions[i], options.truths[i],
                                options.covered_by.empty() ? "" : options.covered_by[i],
                                label_set);
  const Scores scores = computeScores(confusion, evaluated);
  if (!options.output.empty()) {
    writeTextFile(options.output + "/metrics.json", scoresJson(scores, label_set));
    writeTextFile(options.output + "/confusion.csv",
                  confusionCsv(confusion, label_set));
    writePng(options.output + "/confusion.png",
             drawConfusion(confusion, label_set, evaluated));
  }
  if (options.header)
    std::cout << scoresMarkdownHeader(scores, label_set);
  if (!options.row.empty())
    std::cout << scoresMarkdownRow(scores, options.row);
  if (!options.header && options.row.empty())
    std::cout << scoresTable(scores, label_set);
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
