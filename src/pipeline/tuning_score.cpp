// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/tuning_score.h>

#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

double
scoreOf(const TuningCounts& counts, const TuningScore& score)
{
  const Scores refined = computeScores(counts.refined, score.classes);
  if (score.kind == TuningScore::Kind::inclusive)
    return refined.mean.iou_inclusive;
  if (score.kind == TuningScore::Kind::exclusive)
    return refined.mean.iou_exclusive;
  return refined.mean.iou_exclusive -
         computeScores(counts.network, score.classes).mean.iou_exclusive;
}

} // namespace

TuningCounts&
TuningCounts::operator+=(const TuningCounts& other)
{
  network += other.network;
  fused += other.fused;
  refined += other.refined;
  return *this;
}

TuningResult&
TuningResult::operator+=(const TuningResult& other)
{
  at_depth += other.at_depth;
  rendered += other.rendered;
  return *this;
}

double
TuningScore::operator()(const TuningResult& result) const
{
  const double depth = view == View::rendered ? 0.0 : scoreOf(result.at_depth, *this);
  const double drawn = view == View::depth ? 0.0 : scoreOf(result.rendered, *this);
  const double score = 100.0 * (depth + drawn) / (view == View::both ? 2.0 : 1.0);
  return std::isnan(score) ? -std::numeric_limits<double>::infinity() : score;
}

std::string
TuningScore::describe() const
{
  const std::string what = kind == Kind::inclusive   ? "mean inclusive IoU"
                           : kind == Kind::exclusive ? "mean exclusive IoU"
                                                     : "mean exclusive IoU above that "
                                                       "of the network";
  return what + (view == View::both    ? ", mean of at depth and rendered"
                 : view == View::depth ? ", at depth"
                                       : ", rendered");
}

std::vector<Label>
classesThatCount(const LabelSet& label_set)
{
  std::vector<Label> classes;
  for (int label = 1; label <= label_set.size(); ++label) {
    const std::string& name = label_set[Label(label)].name;
    if (name != "sky" && name != "pedestrian" && name != "cyclist")
      classes.push_back(Label(label));
  }
  return classes;
}

} // namespace pcl_semantic
