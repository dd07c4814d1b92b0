// SPDX-License-Identifier: BSD-3-Clause
#include "support/named_classes.h"
#include "support/thrown_message.h"

#include <pcl_semantic/evaluation/panoptic_quality.h>

#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <random>
#include <set>

namespace pcl_semantic {

namespace {

constexpr Label road = 1, car = 2, person = 3;

LabelSet
threeClasses()
{
  std::vector<LabelClass> classes = namedClasses({"road", "car", "person"});
  classes[1].thing = classes[2].thing = true;
  return LabelSet(classes);
}

void
expectCounts(const SegmentCounts& counts, std::uint64_t matched, std::uint64_t missed,
             std::uint64_t false_positives, double iou)
{
  EXPECT_EQ(counts.matched, matched);
  EXPECT_EQ(counts.missed, missed);
  EXPECT_EQ(counts.false_positives, false_positives);
  EXPECT_NEAR(counts.iou, iou, 1e-12);
}

// All points of a car, seen as the car of that number.
ScanSegments
wholeCar(std::uint32_t object, std::size_t points = 4)
{
  return {std::vector<Label>(points, car), std::vector<std::uint32_t>(points, object)};
}

} // namespace

TEST(PanopticQuality, IsAsComputedByHand)
{
  const ScanSegments truth{
      {car, car, car, car, car, car, car, road, road, road, 0, 0, car},
      {1, 1, 1, 1, 2, 2, 2, 0, 5, 0, 1, 0, 0}};
  const ScanSegments prediction{
      {car, car, car, road, car, person, person, road, road, 0, car, car, car},
      {7, 7, 7, 7, 8, 9, 9, 0, 0, 0, 7, 7, 8}};
  const std::vector<Eigen::Vector3d> positions{
      {4, 0, 0},  {6, 1, 1}, {5, 0, 0}, {8, 1, 1}, {15, 0, 0}, {17, 1, 1}, {16, 0, 0},
      {50, 0, 0}, {1, 0, 0}, {1, 0, 0}, {9, 9, 9}, {9, 9, 9},  {9, 9, 9}};
  PanopticQuality quality(threeClasses(), 2);
  quality.add(truth, prediction, positions);

  // Car 8 is too small for a false positive.
  const SegmentCounts cars = quality.counts(car);
  expectCounts(cars, 1, 1, 0, 0.75);
  EXPECT_NEAR(cars.recognitionQuality(), 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(cars.segmentationQuality(), 0.75, 1e-12);
  EXPECT_NEAR(cars.panopticQuality(), 0.5, 1e-12);
  EXPECT_EQ(cars.boxes, 2u);
  EXPECT_EQ(cars.boxes_25, 1u);
  EXPECT_EQ(cars.boxes_50, 1u);
  expectCounts(quality.counts(person), 0, 0, 1, 0.0);
  EXPECT_EQ(quality.counts(person).panopticQuality(), 0.0);
  // Two of four points are common: that is not more than a half.
  expectCounts(quality.counts(road), 0, 1, 1, 0.0);

  expectCounts(quality.counts(car, 0), 1, 0, 0, 0.75);
  expectCounts(quality.counts(car, 1), 0, 1, 0, 0.0);
  expectCounts(quality.counts(person, 1), 0, 0, 1, 0.0);
  EXPECT_TRUE(std::isnan(quality.counts(car, 2).panopticQuality()));

  const AssociationScores scores = quality.association();
  EXPECT_NEAR(scores.association, (9.0 / 16.0 + 1.0 / 9.0 + 4.0 / 9.0) / 2.0, 1e-12);
  EXPECT_EQ(scores.objects, 2u);
  EXPECT_EQ(scores.switches, 0u);
}

TEST(PanopticQuality, NeedsNoPositions)
{
  PanopticQuality quality(threeClasses(), 1);
  quality.add(wholeCar(1), wholeCar(2));
  expectCounts(quality.counts(car), 1, 0, 0, 1.0);
  EXPECT_EQ(quality.counts(car).boxes, 0u);
  for (std::size_t band = 0; band < PanopticQuality::bands.size(); ++band)
    expectCounts(quality.counts(car, band), 0, 0, 0, 0.0);
}

TEST(PanopticQuality, BandsBeginAtTheirLimits)
{
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  PanopticQuality quality(threeClasses(), 1);
  for (const double x : {0.0, 10.0, 39.9, 40.0, 400.0, none})
    quality.add(wholeCar(1, 2), wholeCar(1, 2), {{x, 0, 0}, {none, 0, 0}});
  EXPECT_EQ(quality.counts(car, 0).matched, 1u);
  EXPECT_EQ(quality.counts(car, 1).matched, 1u);
  EXPECT_EQ(quality.counts(car, 2).matched, 1u);
  EXPECT_EQ(quality.counts(car, 3).matched, 2u);
  EXPECT_EQ(quality.counts(car).matched, 6u);
  EXPECT_EQ(quality.counts(car).boxes, 5u);
  EXPECT_EQ(quality.counts(car).boxes_50, 5u) << "flat boxes are equal";
}

TEST(PanopticQuality, CountsSwitchesWithinASequence)
{
  PanopticQuality quality(threeClasses(), 3);
  for (const std::uint32_t number : {1, 1, 0, 2, 2, 1})
    quality.add(wholeCar(5), wholeCar(number));
  EXPECT_EQ(quality.association().switches, 2u);
  // In three of six frames it has number 1, in two number 2.
  const double expected = (12.0 / 24.0 * 12.0 / 24.0 + 8.0 / 24.0 * 8.0 / 24.0);
  EXPECT_NEAR(quality.association().association, expected, 1e-12);
  quality.startSequence();
  quality.add(wholeCar(5), wholeCar(3));
  EXPECT_EQ(quality.association().switches, 2u);
  EXPECT_EQ(quality.association().objects, 2u);
  EXPECT_NEAR(quality.association().association, (expected + 1.0) / 2.0, 1e-12);
  for (const std::uint32_t number : {4, 5}) // too small
    quality.add(wholeCar(5, 2), wholeCar(number, 2));
  EXPECT_EQ(quality.association().switches, 2u);
}

namespace {

using Points = std::set<std::size_t>;

struct NaiveSegment {
  Label label;
  std::uint32_t object; // 0: a class without objects
  Points points;
};

bool
isThing(Label label)
{
  return label == car || label == person;
}

std::vector<NaiveSegment>
segmentsIn(const ScanSegments& scan, const Points& kept)
{
  std::vector<NaiveSegment> segments;
  for (Label label = 1; label <= 3; ++label)
    for (std::uint32_t object = 0; object < 9; ++object) {
      if (isThing(label) != (object > 0))
        continue;
      NaiveSegment segment{label, object, {}};
      for (const std::size_t i : kept)
        if (scan.labels[i] == label && (!isThing(label) || scan.objects[i] == object))
          segment.points.insert(i);
      if (!segment.points.empty())
        segments.push_back(segment);
    }
  return segments;
}

std::size_t
common(const Points& a, const Points& b)
{
  std::size_t count = 0;
  for (const std::size_t i : a)
    count += b.count(i);
  return count;
}

double
iouOf(const Points& a, const Points& b)
{
  return double(common(a, b)) / double(a.size() + b.size() - common(a, b));
}

// Product of the overlaps of the axes.
double
boxIou(const Points& a, const Points& b, const std::vector<Eigen::Vector3d>& positions)
{
  double size_a = 1.0, size_b = 1.0, both = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto limits = [&](const Points& points) {
      double low = HUGE_VAL, high = -HUGE_VAL;
      for (const std::size_t i : points) {
        low = std::min(low, positions[i][axis]);
        high = std::max(high, positions[i][axis]);
      }
      return std::make_pair(low, high);
    };
    const auto [low_a, high_a] = limits(a);
    const auto [low_b, high_b] = limits(b);
    size_a *= high_a - low_a;
    size_b *= high_b - low_b;
    both *= std::max(0.0, std::min(high_a, high_b) - std::max(low_a, low_b));
  }
  return both / (size_a + size_b - both);
}

// Scans whose objects are mostly predicted with their own numbers.
ScanSegments
randomScan(std::mt19937& random)
{
  std::uniform_int_distribution<unsigned> label(0, 3), object(0, 4);
  ScanSegments scan;
  for (int i = 0; i < 60; ++i) {
    scan.labels.push_back(Label(label(random)));
    scan.objects.push_back(object(random));
  }
  return scan;
}

ScanSegments
changed(ScanSegments scan, std::mt19937& random)
{
  const ScanSegments other = randomScan(random);
  for (std::size_t i = 0; i < scan.labels.size(); ++i)
    if (random() % 4 == 0) {
      scan.labels[i] = other.labels[i];
      scan.objects[i] = other.objects[i];
    }
  return scan;
}

} // namespace

TEST(PanopticQuality, IsThatOfANaiveComputation)
{
  constexpr std::size_t min_points = 4;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-9.0, 9.0);
  PanopticQuality quality(threeClasses(), min_points);
  std::vector<SegmentCounts> expected(4);
  // Tubes have the points of all frames: 1000 for each frame.
  std::map<std::uint32_t, Points> true_tubes, predicted_tubes;
  for (std::size_t frame = 0; frame < 20; ++frame) {
    ScanSegments truth = randomScan(random);
    for (std::size_t i = 0; i < truth.labels.size(); ++i) // persons 5 to 8
      truth.objects[i] += truth.labels[i] == person && truth.objects[i] > 0 ? 4 : 0;
    const ScanSegments prediction = changed(truth, random);
    std::vector<Eigen::Vector3d> positions;
    for (std::size_t i = 0; i < truth.labels.size(); ++i)
      positions.emplace_back(coordinate(random), coordinate(random),
                             coordinate(random));
    quality.add(truth, prediction, positions);

    Points kept, tube_points;
    for (std::size_t i = 0; i < truth.labels.size(); ++i)
      if (truth.labels[i] == road || (truth.labels[i] != 0 && truth.objects[i] > 0))
        kept.insert(i);
    const auto truths = segmentsIn(truth, kept),
               predictions = segmentsIn(prediction, kept);
    tube_points = kept;
    std::set<std::size_t> matched;
    for (const NaiveSegment& segment : truths) {
      SegmentCounts& counts = expected[segment.label];
      bool is_matched = false;
      double best_box = 0.0;
      for (std::size_t p = 0; p < predictions.size(); ++p) {
        if (predictions[p].label != segment.label)
          continue;
        best_box = std::max(best_box,
                            boxIou(segment.points, predictions[p].points, positions));
        const double iou = iouOf(segment.points, predictions[p].points);
        if (iou <= 0.5)
          continue;
        is_matched = true;
        matched.insert(p);
        ++counts.matched;
        counts.iou += iou;
      }
      const bool is_small = segment.points.size() < min_points;
      counts.missed += !is_matched && !is_small;
      if (!isThing(segment.label))
        continue;
      if (is_small) {
        for (const std::size_t i : segment.points)
          tube_points.erase(i);
        continue;
      }
      ++counts.boxes;
      counts.boxes_25 += best_box >= 0.25;
      counts.boxes_50 += best_box >= 0.5;
      for (const std::size_t i : segment.points)
        true_tubes[segment.object].insert(1000 * frame + i);
    }
    for (std::size_t p = 0; p < predictions.size(); ++p)
      expected[predictions[p].label].false_positives +=
          matched.count(p) == 0 && predictions[p].points.size() >= min_points;
    for (const std::size_t i : tube_points)
      if (isThing(prediction.labels[i]) && prediction.objects[i] > 0)
        predicted_tubes[prediction.objects[i]].insert(1000 * frame + i);
  }

  for (const Label label : {road, car, person}) {
    SCOPED_TRACE(int(label));
    const SegmentCounts counts = quality.counts(label), &naive = expected[label];
    expectCounts(counts, naive.matched, naive.missed, naive.false_positives, naive.iou);
    EXPECT_GT(counts.matched, 5u);
    EXPECT_EQ(counts.boxes, naive.boxes);
    EXPECT_EQ(counts.boxes_25, naive.boxes_25);
    EXPECT_EQ(counts.boxes_50, naive.boxes_50);
  }
  EXPECT_GT(expected[car].boxes_50, 5u);
  double sum = 0.0;
  for (const auto& [object, truth] : true_tubes)
    for (const auto& [number, prediction] : predicted_tubes)
      sum += double(common(truth, prediction)) * iouOf(truth, prediction) /
             double(truth.size());
  EXPECT_EQ(quality.association().objects, 8u);
  EXPECT_NEAR(quality.association().association, sum / double(true_tubes.size()),
              1e-12);
}

TEST(PanopticQuality, RefusesBadInputAndCountsNothing)
{
  PanopticQuality quality(threeClasses(), 1);
  const ScanSegments four = wholeCar(1);
  expectBadInput("the prediction has 3 labels and 3 objects, expected 4",
                 [&] { quality.add(four, wholeCar(1, 3)); });
  expectBadInput("the scan has 1 points, the ground truth 4", [&] {
    quality.add(four, four, {{1, 2, 3}});
  });
  ScanSegments beyond = four;
  beyond.labels[2] = 4;
  expectBadInput("point 2 of the prediction has label 4, expected 0 to 3",
                 [&] { quality.add(four, beyond); });
  beyond.objects.pop_back();
  expectBadInput("the ground truth has 4 labels and 3 objects",
                 [&] { quality.add(beyond, four); });
  expectCounts(quality.counts(car), 0, 0, 0, 0.0);
  EXPECT_TRUE(std::isnan(quality.association().association));
  EXPECT_TRUE(std::isnan(quality.counts(car).recognitionQuality()));
  EXPECT_TRUE(std::isnan(quality.counts(car).segmentationQuality()));
}

} // namespace pcl_semantic
