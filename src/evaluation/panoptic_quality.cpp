// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/evaluation/panoptic_quality.h>

#include "core/fail.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

using SegmentKey = std::pair<Label, std::uint32_t>; // object 0: the whole class

struct Segment {
  std::uint64_t points = 0;
  double distance = HUGE_VAL; // of the nearest point; infinite = unknown
  Eigen::AlignedBox3d box;    // empty = unknown
  bool is_matched = false;
};

using Segments = std::map<SegmentKey, Segment>;

void
addPoint(Segment& segment, const Eigen::Vector3d* position)
{
  ++segment.points;
  if (!position || !position->allFinite())
    return;
  segment.distance = std::min(segment.distance, position->norm());
  segment.box.extend(*position);
}

double
intersectionOverUnion(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b)
{
  const double common = a.intersection(b).volume();
  const double joined = a.volume() + b.volume() - common;
  return joined > 0.0 ? common / joined : double(a.isApprox(b)); // flat boxes
}

std::size_t
bandOf(double distance)
{
  const auto& bands = PanopticQuality::bands;
  if (!std::isfinite(distance))
    return bands.size();
  return std::size_t(std::upper_bound(bands.begin(), bands.end(), distance) -
                     bands.begin()) -
         1;
}

void
checkSegments(const ScanSegments& segments, std::size_t points, int classes,
              const char* name)
{
  if (segments.labels.size() != points || segments.objects.size() != points)
    badInput(name, " has ", segments.labels.size(), " labels and ",
             segments.objects.size(), " objects, expected ", points);
  for (std::size_t i = 0; i < points; ++i)
    if (segments.labels[i] > classes)
      badInput("point ", i, " of ", name, " has label ", int(segments.labels[i]),
               ", expected 0 to ", classes);
}

} // namespace

double
SegmentCounts::panopticQuality() const
{
  return segmentationQuality() * recognitionQuality();
}

double
SegmentCounts::recognitionQuality() const
{
  const std::uint64_t sum = 2 * matched + missed + false_positives;
  return sum ? 2.0 * double(matched) / double(sum) : kNone;
}

double
SegmentCounts::segmentationQuality() const
{
  if (matched + missed + false_positives == 0)
    return kNone;
  return matched ? iou / double(matched) : 0.0;
}

SegmentCounts&
SegmentCounts::operator+=(const SegmentCounts& other)
{
  matched += other.matched;
  missed += other.missed;
  false_positives += other.false_positives;
  iou += other.iou;
  boxes += other.boxes;
  boxes_25 += other.boxes_25;
  boxes_50 += other.boxes_50;
  return *this;
}

// The segments of one scan, and their numbers of common points.
struct PanopticQuality::Frame {
  Segments truths, predictions;
  std::map<std::pair<SegmentKey, SegmentKey>, std::uint64_t> common;
};

PanopticQuality::PanopticQuality(LabelSet label_set, std::size_t min_points)
    : label_set_(std::move(label_set)), min_points_(min_points),
      counts_(std::size_t(label_set_.size()) + 1)
{}

void
PanopticQuality::startSequence()
{
  ++sequence_;
}

void
PanopticQuality::add(const ScanSegments& truth, const ScanSegments& prediction,
                     const std::vector<Eigen::Vector3d>& positions)
{
  const std::size_t points = truth.labels.size();
  checkSegments(truth, points, label_set_.size(), "the ground truth");
  checkSegments(prediction, points, label_set_.size(), "the prediction");
  if (!positions.empty() && positions.size() != points)
    badInput("the scan has ", positions.size(), " points, the ground truth ", points);
  // A point of a thing without an object is in no segment.
  const auto keyOf = [&](const ScanSegments& segments, std::size_t i) {
    const Label label = segments.labels[i];
    if (!label_set_[label].thing)
      return SegmentKey(label, 0);
    const std::uint32_t object = segments.objects[i];
    return object ? SegmentKey(label, object) : SegmentKey(kUnlabelled, 0);
  };
  Frame frame;
  for (std::size_t i = 0; i < points; ++i) {
    const SegmentKey true_key = keyOf(truth, i);
    if (true_key.first == kUnlabelled)
      continue;
    const Eigen::Vector3d* const position = positions.empty() ? nullptr : &positions[i];
    addPoint(frame.truths[true_key], position);
    const SegmentKey key = keyOf(prediction, i);
    if (key.first == kUnlabelled)
      continue;
    addPoint(frame.predictions[key], position);
    ++frame.common[{true_key, key}];
  }
  addMatches(frame);
  addRest(frame);
  addBoxes(frame);
  addTubes(frame);
}

// An IoU above a half leaves each segment at most one match.
void
PanopticQuality::addMatches(Frame& frame)
{
  for (const auto& [keys, common] : frame.common) {
    if (keys.first.first != keys.second.first)
      continue;
    Segment& truth = frame.truths[keys.first];
    Segment& prediction = frame.predictions[keys.second];
    const std::uint64_t joined = truth.points + prediction.points - common;
    if (2 * common <= joined)
      continue;
    truth.is_matched = prediction.is_matched = true;
    SegmentCounts& counts = counts_[keys.first.first][bandOf(truth.distance)];
    ++counts.matched;
    counts.iou += double(common) / double(joined);
    if (!label_set_[keys.first.first].thing || truth.points < min_points_)
      continue;
    const std::uint32_t number = keys.second.second;
    const auto [last, is_new] =
        last_matches_.try_emplace({sequence_, keys.first.second}, number);
    switches_ += !is_new && last->second != number ? 1 : 0;
    last->second = number;
  }
}

void
PanopticQuality::addRest(const Frame& frame)
{
  for (const auto& [key, segment] : frame.truths)
    if (!segment.is_matched && segment.points >= min_points_)
      ++counts_[key.first][bandOf(segment.distance)].missed;
  for (const auto& [key, segment] : frame.predictions)
    if (!segment.is_matched && segment.points >= min_points_)
      ++counts_[key.first][bandOf(segment.distance)].false_positives;
}

void
PanopticQuality::addBoxes(const Frame& frame)
{
  for (const auto& [key, truth] : frame.truths) {
    if (!label_set_[key.first].thing || truth.points < min_points_ ||
        truth.box.isEmpty())
      continue;
    double best = 0.0;
    for (auto each = frame.predictions.lower_bound({key.first, 0});
         each != frame.predictions.end() && each->first.first == key.first; ++each)
      best = std::max(best, intersectionOverUnion(truth.box, each->second.box));
    SegmentCounts& counts = counts_[key.first][bandOf(truth.distance)];
    ++counts.boxes;
    counts.boxes_25 += best >= 0.25 ? 1 : 0;
    counts.boxes_50 += best >= 0.5 ? 1 : 0;
  }
}

void
PanopticQuality::addTubes(const Frame& frame)
{
  const auto isTube = [&](const SegmentKey& key) {
    return label_set_[key.first].thing && frame.truths.at(key).points >= min_points_;
  };
  for (const auto& [key, truth] : frame.truths)
    if (isTube(key))
      true_tubes_[{sequence_, key.second}] += truth.points;
  for (const auto& [keys, common] : frame.common) {
    const auto& [true_key, key] = keys;
    const bool is_small = label_set_[true_key.first].thing && !isTube(true_key);
    if (is_small || !label_set_[key.first].thing)
      continue;
    const Number number(sequence_, key.second);
    predicted_tubes_[number] += common;
    if (isTube(true_key))
      common_tubes_[{{sequence_, true_key.second}, number}] += common;
  }
}

SegmentCounts
PanopticQuality::counts(Label label) const
{
  SegmentCounts sum;
  for (const SegmentCounts& each : counts_[label])
    sum += each;
  return sum;
}

AssociationScores
PanopticQuality::association() const
{
  AssociationScores scores{kNone, true_tubes_.size(), switches_};
  if (true_tubes_.empty())
    return scores;
  double sum = 0.0;
  for (const auto& [numbers, count] : common_tubes_) {
    const double common = double(count), truth = double(true_tubes_.at(numbers.first));
    const double joined = truth + double(predicted_tubes_.at(numbers.second)) - common;
    sum += common / truth * common / joined;
  }
  scores.association = sum / double(true_tubes_.size());
  return scores;
}

} // namespace pcl_semantic
