// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_doubts.h"
#include "files/is_there.h"
#include "image_tool.h"
#include "label_kind.h"
#include "messages.h"
#include "panoptic_evaluation.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/lidar_scan.h>
#include <pcl_semantic/evaluation/confusion_matrix.h>
#include <pcl_semantic/evaluation/depth_file.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/images/distribution_file.h>
#include <pcl_semantic/images/image_file.h>

#include <opencv2/core.hpp>

#include <filesystem>
#include <iostream>
#include <limits>
#include <optional>

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

namespace fs = std::filesystem;

// Folders contain files of equal names: label images (`.png`), or labels of the points
// of scans (`.label`).
struct Options {
  std::vector<std::string> predictions, truths;
  std::vector<std::string> covered_by;   ///< empty = all pixels count
  std::vector<std::string> truth_depths; ///< `.png` or `.bin`, see readDepths()
  std::vector<std::string> ranges;
  std::vector<std::string> scans; ///< for --panoptic; empty = no distances, no boxes
  std::string label_set, label_mapping;
  std::optional<std::string> ignore;
  std::string output, row;
  bool header = false, panoptic = false;
};

const Usage usage{
    "pcl_semantic_evaluate",
    "--prediction DIR --truth DIR --label-set FILE [options]",
    R"(Compares label images, or labels of scans (.label), with ground truth of the
same names and prints IoU, recall and precision in percent. Exclusive figures
count only pixels that the prediction covers (is not 0). Inclusive figures count
uncovered pixels as misses. Several folders, given in the same order, are
evaluated as one. The first line tells labels of the map at each frame (causal)
and labels of the finished map (final) apart. With --panoptic, compares the
objects of scans instead.)",
    R"(pcl_semantic_evaluate --prediction /tmp/map/labels --truth /tmp/street/gt \
    --label-set data/label_sets/kitti11.yaml --output /tmp/evaluation)",
    {{"prediction DIR", "predicted label images, or labels of scans"},
     {"truth DIR", "ground truth labels (0 = none); each file needs a prediction"},
     {"covered-by DIR", "count only pixels that are not 0 there"},
     {"truth-depth DIR", "ground truth depth, for --range"},
     {"range A:B", "count only ground truth with depth A <= z < B [m]"},
     {"panoptic", "compare objects of scans: PQ, boxes, association"},
     {"scans DIR", "points of the scans, for boxes and distances of --panoptic"},
     {"label-set FILE", "label set (.yaml)"},
     {"label-mapping FILE", "mapping from numbers in the ground truth to classes"},
     {"ignore NAMES", "classes not evaluated, separated by commas, or none"},
     {"output DIR", "folder for metrics.json and confusion.csv, or panoptic.json"},
     {"row NAME", "print a row of a Markdown table with this name"},
     {"header", "print the header of the Markdown table"}}};

Options
parse(int argc, char** argv)
{
  Options options;
  std::string ignore;
  refuseRemoved(argc, argv,
                {{"probabilities", "python3 -m lab.reliability judges them"}});
  const po::variables_map values = parseCommandLine(
      argc, argv, usage,
      {{"prediction", required(options.predictions),
        "folder of predicted label images, or of scan labels"},
       {"truth", required(options.truths),
        "folder of ground truth labels (0 = none); each file needs a prediction"},
       {"covered-by", options.covered_by,
        "folder of label images: count only pixels that are not 0 there"},
       {"truth-depth", options.truth_depths,
        "folder of ground truth depth: .png (256 x metres) or .bin [m]"},
       {"range", options.ranges,
        "A:B = count only ground truth with depth A <= z < B [m]; repeat for several "
        "ranges"},
       {"panoptic", options.panoptic,
        "compare segments of scans, with object numbers in the upper 16 bits of their "
        "labels: panoptic quality, recall of boxes, association over the frames"},
       {"scans", options.scans,
        "folder of the points of the scans (.bin), for distances and boxes of "
        "--panoptic"},
       {"label-set", required(options.label_set), "label set (.yaml)"},
       {"label-mapping", options.label_mapping,
        "mapping from numbers in the ground truth to classes of the label set: file "
        "(.yaml), name of an installed file (semantic_kitti_to_kitti11), zero_based or "
        "colours = images have the class colours (default: numbers are labels, 0 = "
        "none)"},
       {"ignore", ignore,
        "classes not evaluated, as numbers or names separated by commas, or none "
        "(default: sky,pedestrian,cyclist, if in the label set; with --panoptic none)"},
       {"output,o", options.output,
        "output folder for metrics.json and confusion.csv, or panoptic.json"},
       {"row", options.row, "print a row of a Markdown table with this name"},
       {"header", options.header, "print the header of the Markdown table"}});
  refuseUnread(
      values,
      {{options.panoptic, "with --panoptic", {"truth-depth", "range", "row", "header"}},
       {!options.panoptic, "without --panoptic", {"scans"}}});
  refuseIf(manner().json && (options.header || !options.row.empty()),
           "--json and a table in Markdown exclude each other");
  refuseIf(manner().json && options.ranges.size() > 1,
           "--json takes the figures of one --range");
  if (values.count("ignore"))
    options.ignore = ignore;
  else if (options.panoptic)
    options.ignore = "none";
  return options;
}

// Depths from <= z < to [m].
struct DepthRange {
  double from = 0.0;
  double to = std::numeric_limits<double>::infinity();
  std::string text; ///< "10-20 m"
};

// Represents labels of a scan as an image of one row.
cv::Mat
asImage(const std::vector<Label>& labels)
{
  return cv::Mat(1, static_cast<int>(labels.size()), CV_8UC1,
                 const_cast<Label*>(labels.data()))
      .clone();
}

// Compares sizes before decoding, because a small file may unpack to gigabytes.
// \param[in] like image with the expected size
cv::Mat
readLabelFile(const std::string& path, int classes, const std::string& like)
{
  return fs::path(path).extension() == ".label"
             ? asImage(readScanLabels(path, classes))
             : readPng(path, ImageKind::labels, statedImageSize(like), " as " + like);
}

cv::Mat
readTruth(const std::string& path, const cv::Mat& prediction, int classes,
          const PixelMapping& mapping)
{
  if (fs::path(path).extension() != ".label")
    return readLabelImage(path, mapping, prediction.size());
  if (std::holds_alternative<std::monostate>(mapping))
    return asImage(readScanLabels(path, classes));
  if (const auto* const numbers = std::get_if<LabelMapping>(&mapping))
    return asImage(readSemanticKittiLabels(path, *numbers, prediction.total()));
  fail<BadInputException>(path, ": has numbers, but --label-mapping maps colours");
}

cv::Mat
readTruthDepth(const std::string& folder, const std::string& truth_path,
               const cv::Mat& truth)
{
  const fs::path name = fs::path(truth_path).filename();
  const std::string path =
      (fs::path(folder) / name)
          .replace_extension(name.extension() == ".label" ? ".bin" : ".png")
          .string();
  const cv::Size stated = statedImageSize(path);
  if (!stated.empty() && stated != truth.size())
    fail<BadInputException>(path, ": has ", stated.width, " x ", stated.height,
                            " depths, the ground truth ", truth.cols, " x ",
                            truth.rows);
  cv::Mat depth = readDepths(path);
  if (depth.size() != truth.size())
    fail<BadInputException>(path, ": has ", depth.cols, " x ", depth.rows,
                            " depths, the ground truth ", truth.cols, " x ",
                            truth.rows);
  return depth;
}

// The ground truth with a depth in the range; 0 elsewhere.
cv::Mat
truthIn(const DepthRange& range, const cv::Mat& truth, const cv::Mat& depth)
{
  cv::Mat inside = cv::Mat::zeros(truth.size(), CV_8UC1);
  truth.copyTo(inside, (depth > 0.0) & (depth >= range.from) & (depth < range.to));
  return inside;
}

std::string
existing(const std::string& folder, const std::string& name, const std::string& truth)
{
  const std::string path = folder + "/" + name;
  if (!isThere(path))
    fail<BadInputException>(path, ": is missing, expected as the prediction for ",
                            truth);
  return path;
}

// Parses "A:B" in metres; missing limits are 0 or infinite.
DepthRange
parseDepthRange(const std::string& text)
{
  DepthRange range;
  const std::size_t colon = text.find(':');
  const std::string from = text.substr(0, colon);
  const std::string to = colon == std::string::npos ? "" : text.substr(colon + 1);
  bool valid = colon != std::string::npos;
  try {
    if (!from.empty())
      range.from = parseNumber(from, "");
    if (!to.empty())
      range.to = parseNumber(to, "");
  }
  catch (const BadInputException&) {
    valid = false;
  }
  if (!valid || !(range.from >= 0.0 && range.from < range.to))
    fail<InvalidParameterException>("--range is '", text,
                                    "', expected A:B with 0 <= A < B");
  range.text = to.empty() ? "from " + from + " m"
                          : (from.empty() ? "0" : from) + "-" + to + " m";
  return range;
}

// Compares the files of the folders of one --truth.
// \param[in] mapping of the ground truth's classes to the label set; none = identity
// \param[in,out] total a matrix for each depth range of the ground truth, or one
void
compareFolders(const Options& options, std::size_t number,
               const std::vector<DepthRange>& ranges, const LabelSet& label_set,
               const PixelMapping& mapping, std::vector<ConfusionMatrix>& total)
{
  const std::string& folder = options.truths[number];
  const std::vector<FrameFile> files = listFrameFiles(folder, {".png", ".label"});
  if (files.empty())
    fail<BadInputException>(
        folder, ": holds no ground truth, expected 000000.png or 000000.label ...");
  for (const FrameFile& file : files) {
    const std::string name = fs::path(file.path).filename().string();
    const std::string path = existing(options.predictions[number], name, file.path);
    const cv::Mat prediction = readLabelFile(path, label_set.size(), file.path);
    const cv::Mat truth = readTruth(file.path, prediction, label_set.size(), mapping);
    cv::Mat covered, depth;
    if (!options.covered_by.empty())
      covered = readLabelFile(options.covered_by[number] + "/" + name, 255, file.path);
    if (!ranges.empty()) {
      depth = readTruthDepth(options.truth_depths[number], file.path, truth);
      note(file.path + ": " +
           std::to_string(cv::countNonZero((truth > 0) & (depth <= 0.0))) +
           " of its labels have no depth and are in no range");
    }
    try {
      for (std::size_t i = 0; i < total.size(); ++i)
        total[i].add(ranges.empty() ? truth : truthIn(ranges[i], truth, depth),
                     prediction, covered);
    }
    catch (const BadInputException& error) {
      fail<BadInputException>(path, " against ", file.path, ": ", error.what());
    }
  }
}

void
warnIfEmpty(const std::vector<ConfusionMatrix>& confusions)
{
  for (const ConfusionMatrix& confusion : confusions)
    for (int t = 1; t <= confusion.classes(); ++t)
      for (int p = 0; p <= confusion.classes(); ++p)
        if (confusion(Label(t), Label(p)) > 0)
          return;
  warn("no label of the ground truth is a class: there is nothing to compare with");
}

// Warns if most labels are shifted by one class: probably one side counts from 0.
void
warnOfNumbers(const ConfusionMatrix& confusion)
{
  std::uint64_t covered = 0, alike = 0, less = 0, more = 0;
  for (int t = 1; t <= confusion.classes(); ++t)
    for (int p = 0; p <= confusion.classes(); ++p) {
      const std::uint64_t count = confusion(Label(t), Label(p));
      covered += count;
      alike += p == t ? count : 0;
      less += p == t - 1 ? count : 0;
      more += p == t + 1 ? count : 0;
    }
  const std::uint64_t apart = std::max(less, more);
  if (2 * apart <= covered || 10 * alike >= apart)
    return;
  warn(std::to_string(apart) + " of " + std::to_string(covered) +
       " predictions are one " + (less > more ? "less" : "more") +
       " than the ground truth: do the " + (less > more ? "predictions" : "truths") +
       " count classes from 0? --label-mapping zero_based is for ground truth");
}

void
requireFittingOptions(const Options& options)
{
  const std::size_t count = options.truths.size();
  for (const auto& [name, folders] : {std::pair("--prediction", &options.predictions),
                                      std::pair("--covered-by", &options.covered_by),
                                      std::pair("--truth-depth", &options.truth_depths),
                                      std::pair("--scans", &options.scans)})
    if (folders->size() != count && !folders->empty())
      fail<InvalidParameterException>("--truth and ", name, " are given ", count,
                                      " and ", folders->size(),
                                      " times, expected as many of each");
  if (options.ranges.empty() != options.truth_depths.empty())
    fail<InvalidParameterException>("--range and --truth-depth belong together");
  if (options.ranges.size() > 1 && !options.output.empty())
    fail<InvalidParameterException>(
        "--output takes the figures of one --range, not of ", options.ranges.size());
}

void
report(const Options& options, const LabelKind& kind, const ConfusionMatrix& confusion,
       const LabelSet& label_set, const std::vector<Label>& evaluated,
       const std::string& range)
{
  const Scores scores = computeScores(confusion, evaluated);
  const std::string json = jsonWithKind(kind, scoresJson(scores, label_set));
  if (!options.output.empty()) {
    writeTextFile(options.output + "/metrics.json", json);
    writeTextFile(options.output + "/confusion.csv",
                  confusionCsv(confusion, label_set));
  }
  if (!options.row.empty())
    std::cout << scoresMarkdownRow(scores, range.empty() ? options.row
                                                         : options.row + ", " + range);
  if (!options.header && options.row.empty())
    printFigures((range.empty() ? "" : "\n" + range + "\n") +
                     withKind(kind, scoresTable(scores, label_set)),
                 json);
}

void
evaluateSegments(const Options& options, const LabelKind& kind,
                 const LabelSet& label_set, const PixelMapping& mapping,
                 const std::vector<Label>& evaluated)
{
  const PanopticQuality quality = compareSegments(
      {options.truths, options.predictions, options.covered_by, options.scans},
      label_set, mapping, evaluated);
  const std::string json =
      jsonWithKind(kind, panopticJson(quality, evaluated, label_set));
  if (!options.output.empty())
    writeTextFile(options.output + "/panoptic.json", json);
  printFigures(withKind(kind, panopticTable(quality, evaluated, label_set)), json);
}

int
evaluate(const Options& options)
{
  requireFittingOptions(options);
  std::vector<DepthRange> ranges;
  for (const std::string& range : options.ranges)
    ranges.push_back(parseDepthRange(range));
  const LabelSet label_set = readLabelSet(options.label_set);
  const PixelMapping mapping = readPixelMapping(options.label_mapping, label_set);
  const MappingWatch watch(options.label_mapping, mapping, "labels");
  const std::vector<Label> evaluated = evaluatedClasses(options.ignore, label_set);
  if (!options.output.empty())
    makeOutputFolder(options.output);
  const LabelKind kind = kindOf(options.predictions);
  if (options.panoptic) {
    evaluateSegments(options, kind, label_set, mapping, evaluated);
    return exit_done;
  }
  std::vector<ConfusionMatrix> total(std::max<std::size_t>(ranges.size(), 1),
                                     ConfusionMatrix(label_set.size()));
  for (std::size_t i = 0; i < options.truths.size(); ++i)
    compareFolders(options, i, ranges, label_set, mapping, total);
  warnIfEmpty(total);
  for (const ConfusionMatrix& confusion : total)
    warnOfNumbers(confusion);
  if (options.header)
    std::cout << scoresMarkdownHeader(computeScores(total[0], evaluated), label_set);
  for (std::size_t i = 0; i < total.size(); ++i)
    report(options, kind, total[i], label_set, evaluated,
           ranges.empty() ? "" : ranges[i].text);
  return exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return runWithImages(usage.name, [&] { return evaluate(parse(argc, argv)); });
}
