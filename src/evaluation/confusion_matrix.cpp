// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/evaluation/confusion_matrix.h>

#include "core/fail.h"
#include "files/report_text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

namespace pcl_semantic {

namespace {

double
ratio(std::uint64_t numerator, std::uint64_t denominator)
{
  return denominator ? double(numerator) / double(denominator)
                     : std::numeric_limits<double>::quiet_NaN();
}

void
checkImage(const cv::Mat& image, const cv::Mat& truth, int largest, const char* name)
{
  if (image.type() != CV_8UC1)
    badInput(name, " is no 8-bit grey image");
  if (image.size() != truth.size())
    badInput(name, " has ", image.cols, " x ", image.rows, " pixels, the ground truth ",
             truth.cols, " x ", truth.rows);
  double highest = 0.0;
  cv::minMaxLoc(image, nullptr, &highest);
  if (highest > largest)
    badInput(name, " holds the label ", highest, ", expected 0 to ", largest);
}

ClassScores
scoresOf(const ConfusionMatrix& confusion, Label label,
         const std::vector<Label>& evaluated)
{
  ClassScores scores;
  scores.label = label;
  for (int prediction = 0; prediction <= confusion.classes(); ++prediction)
    scores.pixels += confusion(label, static_cast<Label>(prediction));
  scores.covered = scores.pixels - confusion(label, kUnlabelled);
  std::uint64_t predicted = 0;
  for (const Label truth : evaluated)
    predicted += confusion(truth, label);
  const std::uint64_t right = confusion(label, label);
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  scores.iou_exclusive =
      scores.covered ? ratio(right, scores.covered + predicted - right) : none;
  scores.iou_inclusive =
      scores.pixels ? ratio(right, scores.pixels + predicted - right) : none;
  scores.recall = ratio(right, scores.covered);
  scores.precision = ratio(right, predicted);
  return scores;
}

// Mean over the classes for which `present` holds; NaN (the precision of a class that
// was never predicted) counts as 0.
template <typename Present>
double
meanOf(const std::vector<ClassScores>& classes, double ClassScores::*figure,
       const Present& present)
{
  double sum = 0.0;
  std::uint64_t count = 0;
  for (const ClassScores& scores : classes)
    if (present(scores)) {
      sum += std::isnan(scores.*figure) ? 0.0 : scores.*figure;
      ++count;
    }
  return count ? sum / double(count) : std::numeric_limits<double>::quiet_NaN();
}

} // namespace

ConfusionMatrix::ConfusionMatrix(int classes) : classes_(classes)
{
  if (classes < 1 || classes > 255)
    badParameter("number of classes is ", classes, ", expected 1 to 255");
  counts_.assign(std::size_t(classes + 1) * (classes + 1), 0);
}

void
ConfusionMatrix::add(const cv::Mat& truth, const cv::Mat& prediction,
                     const cv::Mat& covered_by)
{
  checkImage(truth, truth, classes_, "the ground truth");
  checkImage(prediction, truth, classes_, "the prediction");
  if (!covered_by.empty())
    checkImage(covered_by, truth, 255, "the image of covered pixels");
  for (int row = 0; row < truth.rows; ++row) {
    const std::uint8_t* const truths = truth.ptr(row);
    const std::uint8_t* const predictions = prediction.ptr(row);
    const std::uint8_t* const covered =
        covered_by.empty() ? nullptr : covered_by.ptr(row);
    for (int column = 0; column < truth.cols; ++column)
      if (!covered || covered[column])
        ++counts_[std::size_t(truths[column]) * (classes_ + 1) + predictions[column]];
  }
}

void
ConfusionMatrix::add(Label truth, Label prediction, std::uint64_t count)
{
  if (truth > classes_ || prediction > classes_)
    badParameter("labels are ", int(truth), " and ", int(prediction),
                 ", expected 0 to ", classes_);
  counts_[std::size_t(truth) * (classes_ + 1) + prediction] += count;
}

ConfusionMatrix&
ConfusionMatrix::operator+=(const ConfusionMatrix& other)
{
  if (other.classes_ != classes_)
    badParameter("a confusion matrix of ", other.classes_,
                 " classes cannot be added to one of ", classes_);
  std::transform(other.counts_.begin(), other.counts_.end(), counts_.begin(),
                 counts_.begin(), std::plus<>());
  return *this;
}

Scores
computeScores(const ConfusionMatrix& confusion, const std::vector<Label>& evaluated)
{
  for (const Label label : evaluated)
    if (label == kUnlabelled || label > confusion.classes())
      badParameter("class ", int(label), " cannot be evaluated, expected 1 to ",
                   confusion.classes());
  Scores scores;
  std::uint64_t right = 0;
  double weighted = 0.0;
  ClassScores& mean = scores.mean;
  for (const Label label : evaluated) {
    scores.classes.push_back(scoresOf(confusion, label, evaluated));
    const ClassScores& latest = scores.classes.back();
    mean.pixels += latest.pixels;
    mean.covered += latest.covered;
    right += confusion(label, label);
    if (latest.covered)
      weighted += double(latest.covered) * latest.iou_exclusive;
  }
  const auto present = [](const ClassScores& c) { return c.pixels > 0; };
  const auto covered = [](const ClassScores& c) { return c.covered > 0; };
  const std::vector<ClassScores>& classes = scores.classes;
  mean.iou_exclusive = meanOf(classes, &ClassScores::iou_exclusive, covered);
  mean.iou_inclusive = meanOf(classes, &ClassScores::iou_inclusive, present);
  mean.recall = meanOf(classes, &ClassScores::recall, covered);
  mean.precision = meanOf(classes, &ClassScores::precision, covered);
  scores.global_accuracy = ratio(right, mean.covered);
  scores.frequency_weighted_iou = weighted / double(mean.covered); // 0 / 0 is NaN
  scores.coverage = ratio(mean.covered, mean.pixels);
  return scores;
}

namespace {

std::string
percent(double ratio)
{
  return std::isnan(ratio) ? "-" : cv::format("%.1f", 100.0 * ratio);
}

std::string
tableLine(const std::string& name, int name_width, const ClassScores& scores)
{
  std::string line = cv::format("%-*s", name_width, name.c_str());
  for (const double ratio :
       {scores.iou_exclusive, scores.iou_inclusive, scores.recall, scores.precision})
    line += cv::format("%15s", percent(ratio).c_str());
  return line + cv::format("%12s\n", std::to_string(scores.pixels).c_str());
}

nlohmann::ordered_json
jsonOf(const ClassScores& scores)
{
  return {{"iou_exclusive", scores.iou_exclusive},
          {"iou_inclusive", scores.iou_inclusive},
          {"recall", scores.recall},
          {"precision", scores.precision},
          {"pixels", scores.pixels},
          {"covered_pixels", scores.covered}};
}

} // namespace

std::string
scoresTable(const Scores& scores, const LabelSet& label_set)
{
  int width = 5; // of "class"
  for (const ClassScores& row : scores.classes)
    width = std::max(width, static_cast<int>(label_set[row.label].name.size()));
  std::string text =
      cv::format("%-*s%15s%15s%15s%15s%12s\n", width, "class", "IoU exclusive",
                 "IoU inclusive", "recall", "precision", "pixels");
  for (const ClassScores& row : scores.classes)
    text += tableLine(label_set[row.label].name, width, row);
  return text + tableLine("mean", width, scores.mean) +
         cv::format("\nglobal accuracy         %6s\nfrequency-weighted IoU  %6s\n"
                    "coverage                %6s\n",
                    percent(scores.global_accuracy).c_str(),
                    percent(scores.frequency_weighted_iou).c_str(),
                    percent(scores.coverage).c_str());
}

std::string
scoresMarkdownHeader(const Scores& scores, const LabelSet& label_set)
{
  std::string titles = "| |", rule = "|---|";
  for (const ClassScores& row : scores.classes) {
    titles += " " + label_set[row.label].name + " |";
    rule += "---:|";
  }
  return titles + " mean | global accuracy | mean inclusive | coverage |\n" + rule +
         "---:|---:|---:|---:|\n";
}

std::string
scoresMarkdownRow(const Scores& scores, const std::string& name)
{
  std::string text = "| ";
  for (const char letter : name)
    text += letter == '|' ? std::string("\\|") : std::string(1, letter); // escapes cell
                                                                         // separators
  text += " |";
  for (const ClassScores& row : scores.classes)
    text += " " + percent(row.iou_exclusive) + " |";
  for (const double ratio : {scores.mean.iou_exclusive, scores.global_accuracy,
                             scores.mean.iou_inclusive, scores.coverage})
    text += " " + percent(ratio) + " |";
  return text + "\n";
}

std::string
scoresJson(const Scores& scores, const LabelSet& label_set)
{
  nlohmann::ordered_json json;
  json["classes"] = nlohmann::ordered_json::array();
  for (const ClassScores& row : scores.classes) {
    nlohmann::ordered_json entry = {{"label", int(row.label)},
                                    {"name", label_set[row.label].name}};
    entry.update(jsonOf(row));
    json["classes"].push_back(entry);
  }
  json["mean"] = jsonOf(scores.mean);
  json["global_accuracy"] = scores.global_accuracy;
  json["frequency_weighted_iou"] = scores.frequency_weighted_iou;
  json["coverage"] = scores.coverage;
  return jsonText(json);
}

std::string
confusionCsv(const ConfusionMatrix& confusion, const LabelSet& label_set)
{
  TextStream text;
  text << "truth \\ prediction,uncovered";
  for (int label = 1; label <= confusion.classes(); ++label)
    text << "," << csvField(label_set[static_cast<Label>(label)].name);
  text << "\n";
  for (int truth = 0; truth <= confusion.classes(); ++truth) {
    text << csvField(label_set[static_cast<Label>(truth)].name);
    for (int prediction = 0; prediction <= confusion.classes(); ++prediction)
      text << ","
           << confusion(static_cast<Label>(truth), static_cast<Label>(prediction));
    text << "\n";
  }
  return text.str();
}

} // namespace pcl_semantic
