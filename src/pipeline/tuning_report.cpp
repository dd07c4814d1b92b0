// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/evaluation/evaluation_report.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/pipeline/tuning_report.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

namespace pcl_semantic {

namespace {

std::string
percent(double value)
{
  if (!std::isfinite(value))
    return "-";
  char text[32];
  std::snprintf(text, sizeof(text), "%.2f", value);
  return text;
}

// Start, choice and held out of some sequences, and the two gains.
std::string
gainRow(const std::string& name, double start, double chosen, double held_out)
{
  const auto gain = [start](double value) {
    return (value >= start ? "+" : "") + percent(value - start);
  };
  return "| " + name + " | " + percent(start) + " | " + percent(chosen) + " | " +
         percent(held_out) + " | " + gain(chosen) + " | " + gain(held_out) + " |\n";
}

std::string
gains(const Tuner& tuner)
{
  const TuningScore& score = tuner.options().score;
  const TuningChoice start = tuner.grid().startChoice();
  std::string text =
      "| | start | chosen on all | chosen on the others | gain in training | gain held "
      "out |\n|---|---:|---:|---:|---:|---:|\n";
  for (std::size_t i = 0; i < tuner.sequences().size(); ++i)
    text += gainRow(tuner.sequences()[i], score(tuner.result(start, i)),
                    score(tuner.result(tuner.chosen(), i)),
                    score(tuner.result(tuner.chosenWithout(i), i)));
  return text + gainRow("pooled", score(tuner.pooled(start)),
                        score(tuner.pooled(tuner.chosen())), score(tuner.heldOut()));
}

std::string
valuesChosen(const Tuner& tuner)
{
  std::string text = "| parameter | start | chosen |";
  std::string rule = "|---|---|---|";
  for (const std::string& sequence : tuner.sequences()) {
    text += " without " + sequence + " |";
    rule += "---|";
  }
  text += "\n" + rule + "\n";
  for (std::size_t i = 0; i < tuner.grid().axes.size(); ++i) {
    const TuningAxis& axis = tuner.grid().axes[i];
    text += "| `" + axis.name + "` | " + axis.candidates[axis.start] + " | " +
            axis.candidates[tuner.chosen()[i]] + " |";
    for (std::size_t s = 0; s < tuner.sequences().size(); ++s)
      text += " " + axis.candidates[tuner.chosenWithout(s)[i]] + " |";
    text += "\n";
  }
  return text;
}

// The classes of one view, pooled.
std::string
classTable(const Tuner& tuner, const LabelSet& label_set,
           TuningCounts TuningResult::*view)
{
  const std::vector<Label>& classes = tuner.options().score.classes;
  const TuningResult start = tuner.pooled(tuner.grid().startChoice());
  const TuningResult chosen = tuner.pooled(tuner.chosen());
  const TuningResult held_out = tuner.heldOut();
  std::string text =
      scoresMarkdownHeader(computeScores((start.*view).refined, classes), label_set);
  for (const auto& [name, result] :
       {std::pair("start", &start), std::pair("chosen on all", &chosen),
        std::pair("chosen on the others", &held_out)})
    for (const auto& [what, counts] :
         {std::pair(": 2D network, covered pixels", &TuningCounts::network),
          std::pair(": fused, before CRF", &TuningCounts::fused),
          std::pair(": after CRF", &TuningCounts::refined)})
      text += scoresMarkdownRow(computeScores((result->*view).*counts, classes),
                                std::string(name) + what);
  return text;
}

} // namespace

std::string
tuningTable(const Tuner& tuner)
{
  std::vector<std::pair<double, TuningChoice>> rows;
  for (const auto& [choice, score] : tuner.scores())
    rows.emplace_back(score, choice);
  std::stable_sort(rows.begin(), rows.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::string text;
  for (const TuningAxis& axis : tuner.grid().axes)
    text += axis.name + "\t";
  text += "score";
  for (const std::string& sequence : tuner.sequences())
    text += "\tscore " + sequence;
  text += "\tdepth\trendered\tdepth inclusive\trendered inclusive\n";
  const std::vector<Label>& classes = tuner.options().score.classes;
  for (const auto& [score, choice] : rows) {
    for (std::size_t i = 0; i < choice.size(); ++i)
      text += tuner.grid().axes[i].candidates[choice[i]] + "\t";
    text += percent(score);
    for (std::size_t s = 0; s < tuner.sequences().size(); ++s)
      text += "\t" + percent(tuner.options().score(tuner.result(choice, s)));
    const TuningResult result = tuner.pooled(choice);
    const Scores depth = computeScores(result.at_depth.refined, classes);
    const Scores rendered = computeScores(result.rendered.refined, classes);
    for (const double value : {depth.mean.iou_exclusive, rendered.mean.iou_exclusive,
                               depth.mean.iou_inclusive, rendered.mean.iou_inclusive})
      text += "\t" + percent(100.0 * value);
    text += "\n";
  }
  return text;
}

std::string
tuningReport(const Tuner& tuner, const LabelSet& label_set, const std::string& data)
{
  std::string text = "# Parameters from data\n\n";
  std::istringstream lines(data);
  for (std::string line; std::getline(lines, line);)
    text += "- " + line + "\n";
  text += "\n";
  text += "Score: " + tuner.options().score.describe() +
          ", in percent, over the pooled pixels of the sequences. " +
          std::to_string(tuner.scores().size()) +
          " configurations were looked at. Chosen is the one that changes the least of "
          "the start among those at most " +
          percent(tuner.options().margin) +
          " points below the best. *Held out*: each sequence with what a search on the "
          "others alone chose.\n\n";
  text += gains(tuner) + "\n" + valuesChosen(tuner);
  text += "\n![Score over each parameter](sensitivity.png)\n";
  text += "\n## At depth\n\n" + classTable(tuner, label_set, &TuningResult::at_depth);
  text += "\n## Rendered\n\n" + classTable(tuner, label_set, &TuningResult::rendered);
  return text;
}

void
writeTuning(const std::string& folder, const Tuner& tuner, const LabelSet& label_set,
            const std::string& data)
{
  writeTextFile(folder + "/best.yaml",
                printMapperConfig(tuner.grid().config(tuner.chosen())));
  writeTextFile(folder + "/table.tsv", tuningTable(tuner));
  writeTextFile(folder + "/report.md", tuningReport(tuner, label_set, data));
  writePng(folder + "/sensitivity.png", drawSensitivity(tuner));
}

} // namespace pcl_semantic
