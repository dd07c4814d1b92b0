// SPDX-License-Identifier: BSD-3-Clause
#include "panoptic_evaluation.h"

#include "core/fail.h"
#include "files/report_text.h"
#include "messages.h"

#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/dataset/lidar_scan.h>
#include <pcl_semantic/files/input_file.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <variant>

namespace pcl_semantic::tool {

namespace {

namespace fs = std::filesystem;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::vector<Label>
readTrueLabels(const std::string& path, std::size_t points, int classes,
               const PixelMapping& mapping)
{
  if (std::holds_alternative<std::monostate>(mapping))
    return readScanLabels(path, classes);
  if (const auto* const numbers = std::get_if<LabelMapping>(&mapping))
    return readSemanticKittiLabels(path, *numbers, points);
  fail<BadInputException>(path, ": has numbers, but --label-mapping maps colours");
}

// The number of a true object includes its class: objects of SemanticKITTI's classes
// are counted class by class, and several of these classes may be one of the label set.
ScanSegments
readTruth(const std::string& path, int classes, const PixelMapping& mapping)
{
  ScanSegments truth;
  truth.objects = readScanNumbers(path);
  truth.labels = readTrueLabels(path, truth.objects.size(), classes, mapping);
  for (std::uint32_t& number : truth.objects)
    if (number == classOf(number))
      number = 0;
  return truth;
}

ScanSegments
readPrediction(const std::string& path, int classes)
{
  ScanSegments prediction{readScanLabels(path, classes), readScanNumbers(path)};
  for (std::uint32_t& number : prediction.objects)
    number >>= 16;
  return prediction;
}

std::vector<Eigen::Vector3d>
readPositions(const std::string& path)
{
  std::vector<Eigen::Vector3d> positions;
  const auto scan = readVelodyneScan(path);
  for (const pcl::PointXYZI& point : *scan)
    positions.push_back(isReturn(point) ? Eigen::Vector3d(point.x, point.y, point.z)
                                        : Eigen::Vector3d(kNone, kNone, kNone));
  return positions;
}

void
keepOnly(const std::vector<Label>& evaluated, std::vector<Label>& labels)
{
  for (Label& label : labels)
    if (std::find(evaluated.begin(), evaluated.end(), label) == evaluated.end())
      label = kUnlabelled;
}

void
requireSize(const std::string& path, std::size_t points, std::size_t expected,
            const std::string& truth)
{
  if (points != expected)
    fail<BadInputException>(path, ": has ", points, " points, expected ", expected,
                            " as ", truth);
}

} // namespace

PanopticQuality
compareSegments(const ScanFolders& folders, const LabelSet& label_set,
                const PixelMapping& mapping, const std::vector<Label>& evaluated)
{
  PanopticQuality quality(label_set);
  bool has_truth = false;
  for (std::size_t i = 0; i < folders.truths.size(); ++i) {
    const std::vector<FrameFile> files = listFrameFiles(folders.truths[i], {".label"});
    if (files.empty())
      fail<BadInputException>(folders.truths[i],
                              ": holds no ground truth, expected 000000.label ...");
    quality.startSequence();
    for (const FrameFile& file : files) {
      const fs::path name = fs::path(file.path).filename();
      ScanSegments truth = readTruth(file.path, label_set.size(), mapping);
      const auto inFolder = [&](const std::string& folder, const char* extension) {
        return folder + "/" + fs::path(name).replace_extension(extension).string();
      };
      const auto requireSameSize = [&](const std::string& path, std::size_t points) {
        requireSize(path, points, truth.labels.size(), file.path);
      };
      const std::string path = inFolder(folders.predictions[i], ".label");
      ScanSegments prediction = readPrediction(path, label_set.size());
      requireSameSize(path, prediction.labels.size());
      if (!folders.covered_by.empty()) {
        const std::string cover = inFolder(folders.covered_by[i], ".label");
        const std::vector<Label> covered = readScanLabels(cover, 255);
        requireSameSize(cover, covered.size());
        for (std::size_t p = 0; p < covered.size(); ++p)
          truth.labels[p] = covered[p] ? truth.labels[p] : kUnlabelled;
      }
      std::vector<Eigen::Vector3d> positions;
      if (!folders.scans.empty()) {
        const std::string scan = inFolder(folders.scans[i], ".bin");
        positions = readPositions(scan);
        requireSameSize(scan, positions.size());
      }
      keepOnly(evaluated, truth.labels);
      keepOnly(evaluated, prediction.labels);
      has_truth = has_truth || std::any_of(truth.labels.begin(), truth.labels.end(),
                                           [](Label label) { return label != 0; });
      quality.add(truth, prediction, positions);
    }
  }
  if (!has_truth)
    warn("no label of the ground truth is a class: there is nothing to compare with");
  return quality;
}

namespace {

// Mean qualities of classes that have segments, and the sum of their counts.
struct Row {
  std::string name;
  double pq = kNone, sq = kNone, rq = kNone;
  SegmentCounts counts;
};

Row
meanOf(const std::string& name, const std::vector<SegmentCounts>& classes)
{
  double pq = 0.0, sq = 0.0, rq = 0.0, count = 0.0;
  Row row;
  row.name = name;
  for (const SegmentCounts& each : classes) {
    row.counts += each;
    if (std::isnan(each.panopticQuality()))
      continue;
    pq += each.panopticQuality();
    sq += each.segmentationQuality();
    rq += each.recognitionQuality();
    ++count;
  }
  row.pq = pq / count; // 0 / 0 is NaN
  row.sq = sq / count;
  row.rq = rq / count;
  return row;
}

std::string
bandName(std::size_t band)
{
  const auto& bands = PanopticQuality::bands;
  return band + 1 < bands.size() ? cv::format("%g-%g m", bands[band], bands[band + 1])
                                 : cv::format("from %g m", bands[band]);
}

std::vector<Row>
bandsOf(const PanopticQuality& quality, const std::vector<Label>& labels)
{
  std::vector<Row> rows;
  for (std::size_t band = 0; band < PanopticQuality::bands.size(); ++band) {
    std::vector<SegmentCounts> classes;
    for (const Label label : labels)
      classes.push_back(quality.counts(label, band));
    rows.push_back(meanOf(bandName(band), classes));
  }
  return rows;
}

std::vector<Row>
meansOf(const PanopticQuality& quality, const std::vector<Label>& evaluated,
        const LabelSet& label_set)
{
  std::vector<SegmentCounts> things, stuff, all;
  for (const Label label : evaluated) {
    all.push_back(quality.counts(label));
    (label_set[label].thing ? things : stuff).push_back(all.back());
  }
  return {meanOf("things", things), meanOf("stuff", stuff), meanOf("all", all)};
}

std::vector<Label>
thingsOf(const std::vector<Label>& labels, const LabelSet& label_set)
{
  std::vector<Label> things;
  for (const Label label : labels)
    if (label_set[label].thing)
      things.push_back(label);
  return things;
}

double
ratio(std::uint64_t numerator, std::uint64_t denominator)
{
  return denominator ? double(numerator) / double(denominator) : kNone;
}

std::string
percent(double value)
{
  return std::isnan(value) ? "-" : cv::format("%.1f", 100.0 * value);
}

std::string
tableOf(const char* title, const std::vector<Row>& rows, int width)
{
  std::string text =
      cv::format("%-*s%8s%8s%8s%10s%10s%8s%10s%10s\n", width, title, "PQ", "SQ", "RQ",
                 "segments", "matched", "false", "box 0.25", "box 0.5");
  for (const Row& row : rows) {
    const SegmentCounts& counts = row.counts;
    text += cv::format("%-*s%8s%8s%8s%10s%10s%8s%10s%10s\n", width, row.name.c_str(),
                       percent(row.pq).c_str(), percent(row.sq).c_str(),
                       percent(row.rq).c_str(),
                       std::to_string(counts.matched + counts.missed).c_str(),
                       std::to_string(counts.matched).c_str(),
                       std::to_string(counts.false_positives).c_str(),
                       percent(ratio(counts.boxes_25, counts.boxes)).c_str(),
                       percent(ratio(counts.boxes_50, counts.boxes)).c_str());
  }
  return text;
}

using Json = nlohmann::ordered_json;

Json
jsonOf(const Row& row)
{
  const SegmentCounts& counts = row.counts;
  return {{"pq", row.pq},
          {"sq", row.sq},
          {"rq", row.rq},
          {"segments", counts.matched + counts.missed},
          {"matched", counts.matched},
          {"false_positives", counts.false_positives},
          {"box_recall_25", ratio(counts.boxes_25, counts.boxes)},
          {"box_recall_50", ratio(counts.boxes_50, counts.boxes)}};
}

bool
haveSegments(const std::vector<Row>& rows)
{
  return std::any_of(rows.begin(), rows.end(),
                     [](const Row& row) { return !std::isnan(row.pq); });
}

// Scores of the classes, and those at each distance, if there are any.
Json
withDistances(const Row& row, const PanopticQuality& quality,
              const std::vector<Label>& labels)
{
  Json json = jsonOf(row);
  const std::vector<Row> bands = bandsOf(quality, labels);
  for (std::size_t b = 0; b < bands.size() && haveSegments(bands); ++b) {
    Json band = {{"from", PanopticQuality::bands[b]}};
    band.update(jsonOf(bands[b]));
    json["distances"].push_back(band);
  }
  return json;
}

} // namespace

std::string
panopticTable(const PanopticQuality& quality, const std::vector<Label>& evaluated,
              const LabelSet& label_set)
{
  std::vector<Row> rows;
  int width = 14;
  for (const Label label : evaluated) {
    rows.push_back(meanOf(label_set[label].name, {quality.counts(label)}));
    width = std::max(width, int(rows.back().name.size()));
  }
  for (const Row& mean : meansOf(quality, evaluated, label_set))
    rows.push_back(mean);
  std::string text = tableOf("class", rows, width);
  const std::vector<Row> bands = bandsOf(quality, thingsOf(evaluated, label_set));
  if (haveSegments(bands))
    text += "\n" + tableOf("things at", bands, width);
  const AssociationScores scores = quality.association();
  return text + cv::format("\nassociation %6s\nswitches    %6s\nobjects     %6s\n",
                           percent(scores.association).c_str(),
                           std::to_string(scores.switches).c_str(),
                           std::to_string(scores.objects).c_str());
}

std::string
panopticJson(const PanopticQuality& quality, const std::vector<Label>& evaluated,
             const LabelSet& label_set)
{
  Json json;
  json["classes"] = Json::array();
  for (const Label label : evaluated) {
    const std::string& name = label_set[label].name;
    Json entry = {
        {"label", int(label)}, {"name", name}, {"thing", label_set[label].thing}};
    entry.update(
        withDistances(meanOf(name, {quality.counts(label)}), quality, {label}));
    json["classes"].push_back(entry);
  }
  for (const Row& mean : meansOf(quality, evaluated, label_set))
    json[mean.name] = mean.name == "things"
                          ? withDistances(mean, quality, thingsOf(evaluated, label_set))
                          : jsonOf(mean);
  const AssociationScores scores = quality.association();
  json["association"] = scores.association;
  json["switches"] = scores.switches;
  json["objects"] = scores.objects;
  return jsonText(json);
}

} // namespace pcl_semantic::tool
