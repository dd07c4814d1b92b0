// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/evaluation/evaluation_report.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <sstream>

namespace pcl_semantic {

namespace {

/** \brief A ratio in percent with one decimal; "-" if there is none. */
std::string
percent(double ratio)
{
  if (std::isnan(ratio))
    return "-";
  char text[16];
  std::snprintf(text, sizeof(text), "%.1f", 100.0 * ratio);
  return text;
}

std::string
padded(const std::string& text, int width)
{
  const std::string blanks(std::max(0, width - static_cast<int>(text.size())), ' ');
  return blanks + text;
}

std::string
tableLine(const std::string& name, int name_width, const ClassScores& scores)
{
  std::string line = name + std::string(name_width - name.size(), ' ');
  for (const double ratio :
       {scores.iou_exclusive, scores.iou_inclusive, scores.recall, scores.precision})
    line += padded(percent(ratio), 15);
  return line + padded(std::to_string(scores.pixels), 12) + "\n";
}

nlohmann::ordered_json
jsonOf(const ClassScores& scores)
{
  const auto number = [](double ratio) {
    return std::isnan(ratio) ? nlohmann::ordered_json() : nlohmann::ordered_json(ratio);
  };
  return {{"iou_exclusive", number(scores.iou_exclusive)},
          {"iou_inclusive", number(scores.iou_inclusive)},
          {"recall", number(scores.recall)},
          {"precision", number(scores.precision)},
          {"pixels", scores.pixels},
          {"covered_pixels", scores.covered}};
}

} // namespace

std::string
scoresTable(const Scores& scores, const LabelSet& label_set)
{
  std::size_t width = std::string("class").size();
  for (const ClassScores& row : scores.classes)
    width = std::max(width, label_set[row.label].name.size());
  const int name_width = static_cast<int>(width);
  std::string text = "class" + std::string(name_width - 5, ' ');
  for (const char* title : {"IoU exclusive", "IoU inclusive", "recall", "precision"})
    text += padded(title, 15);
  text += padded("pixels", 12) + "\n";
  for (const ClassScores& row : scores.classes)
    text += tableLine(label_set[row.label].name, name_width, row);
  text += tableLine("mean", name_width, scores.mean);
  text += "\nglobal accuracy         " + padded(percent(scores.global_accuracy), 6);
  text +=
      "\nfrequency-weighted IoU  " + padded(percent(scores.frequency_weighted_iou), 6);
  text += "\ncoverage                " + padded(percent(scores.coverage), 6) + "\n";
  return text;
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
    text += letter == '|' ? std::string("\\|") : std::string(1, letter); // of a cell
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
  // NaN becomes null.
  json["global_accuracy"] = scores.global_accuracy;
  json["frequency_weighted_iou"] = scores.frequency_weighted_iou;
  json["coverage"] = scores.coverage;
  return json.dump(2) + "\n";
}

std::string
confusionCsv(const ConfusionMatrix& confusion, const LabelSet& label_set)
{
  std::ostringstream text;
  text << "truth \\ prediction,uncovered";
  for (int label = 1; label <= confusion.classes(); ++label)
    text << "," << label_set[static_cast<Label>(label)].name;
  text << "\n";
  for (int truth = 0; truth <= confusion.classes(); ++truth) {
    text << label_set[static_cast<Label>(truth)].name;
    for (int prediction = 0; prediction <= confusion.classes(); ++prediction)
      text << ","
           << confusion(static_cast<Label>(truth), static_cast<Label>(prediction));
    text << "\n";
  }
  return text.str();
}

} // namespace pcl_semantic
