// SPDX-License-Identifier: BSD-3-Clause
#include "support/plain_calibration.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>

#include <gtest/gtest.h>

#include <functional>

namespace pcl_semantic {
namespace {

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

const LabelSet&
fiveClasses()
{
  static const LabelSet label_set({{"house"}, {"road"}, {"path"}, {"tree"}, {"post"}});
  return label_set;
}

// Of class 4 nothing was learned.
LabelCalibration
makeCalibration()
{
  LabelCalibration calibration = randomCalibration(5, 3);
  calibration.fitted[3] = false;
  calibration.ground = {3, 2};
  return calibration;
}

// A calibration with histograms of its training data.
LabelCalibration
makeExperiencedCalibration()
{
  LabelCalibration calibration = makeCalibration();
  const LabelDistributions network = randomNetwork(5, 400, 21);
  const std::vector<PointFeatures> features = randomFeatures(400, 22);
  for (const ClassCurves& each : calibration.curves)
    calibration.seen.push_back(
        featureHistogram(each.feature, each.knots, network, features));
  calibration.usual_distance = 0.25f;
  return calibration;
}

double
largestDifference(const LabelDistributions& a, const Eigen::MatrixXd& b)
{
  return (a.matrix().cast<double>() - b).cwiseAbs().maxCoeff();
}

TEST(LabelCalibration, AgreesWithThePlainFormula)
{
  const LabelDistributions network = randomNetwork(5, 3000, 1);
  const std::vector<PointFeatures> features = randomFeatures(3000, 2);
  const LabelCalibration calibration = makeCalibration();
  const LabelDistributions result = calibrate(calibration, network, features);
  EXPECT_LT(largestDifference(result, plainCalibrate(calibration, network, features)),
            2e-6);
  EXPECT_GT((result.matrix() - network.matrix()).cwiseAbs().maxCoeff(), 0.3f);
}

TEST(LabelCalibration, KeepsWhatItWasNotFittedFor)
{
  LabelDistributions network = randomNetwork(5, 500, 4);
  network.matrix().col(7).setZero();
  network.setLabel(8, 4, 1.0f); // nothing is left to share
  const LabelDistributions result =
      calibrate(makeCalibration(), network, randomFeatures(500, 5));
  EXPECT_EQ(result.matrix().row(3), network.matrix().row(3));
  EXPECT_EQ(result.matrix().col(7), network.matrix().col(7));
  EXPECT_EQ(result.matrix().col(8), network.matrix().col(8));
  for (Eigen::Index i = 0; i < result.size(); ++i)
    if (i != 7) {
      EXPECT_NEAR(result.matrix().col(i).sum(), 1.0f, 1e-6f) << i;
    }
  LabelCalibration nothing = makeCalibration();
  nothing.fitted.assign(5, false);
  EXPECT_EQ(calibrate(nothing, network, {}).matrix(), network.matrix());
}

TEST(LabelCalibration, LeavesOutCurvesOverWhatIsNotKnown)
{
  const LabelDistributions network = randomNetwork(5, 200, 6);
  const LabelCalibration calibration = makeCalibration();
  LabelCalibration no_height = calibration, no_curves = calibration;
  no_height.curves.erase(no_height.curves.begin());
  no_curves.curves.clear();
  std::vector<PointFeatures> places(200, featuresAt(0.7f, 12.0f, 0.4f)),
      without = places;
  for (PointFeatures& place : without)
    place[Feature::height] = unknown;
  EXPECT_EQ(calibrate(calibration, network, without).matrix(),
            calibrate(no_height, network, places).matrix());
  EXPECT_NE(calibrate(calibration, network, without).matrix(),
            calibrate(calibration, network, places).matrix());
  const LabelDistributions nowhere = calibrate(no_curves, network, places);
  EXPECT_EQ(calibrate(calibration, network, {}).matrix(), nowhere.matrix());
  EXPECT_EQ(calibrate(calibration, network, std::vector<PointFeatures>(200)).matrix(),
            nowhere.matrix());
}

TEST(LabelCalibration, IsLevelBeyondTheKnots)
{
  const LabelDistributions network = randomNetwork(5, 100, 8);
  const LabelCalibration calibration = makeCalibration();
  const auto at = [&](float height, float distance) {
    return calibrate(
               calibration, network,
               std::vector<PointFeatures>(100, featuresAt(height, distance, 0.5f)))
        .matrix();
  };
  const float low = calibration.curves[0].knots.front();
  const float high = calibration.curves[0].knots.back();
  const float far = calibration.curves[1].knots.back();
  EXPECT_EQ(at(low - 100.0f, far + 1.0f), at(low, far));
  EXPECT_EQ(at(high + 0.01f, far + 1e6f), at(high, far));
  EXPECT_NE(at(low, far), at(high, far));
}

TEST(LabelCalibration, TheIdentityOnlyClamps)
{
  const LabelDistributions network = randomNetwork(5, 1000, 9);
  const LabelDistributions result =
      calibrate(LabelCalibration::identity(5), network, randomFeatures(1000, 10));
  Eigen::MatrixXf clamped = network.matrix().cwiseMax(1e-4f);
  clamped.array().rowwise() /= clamped.colwise().sum().eval().array();
  EXPECT_LT((result.matrix() - clamped).cwiseAbs().maxCoeff(), 1e-6f);
  EXPECT_LT(network.matrix().minCoeff(), 1e-4f); // or nothing was clamped
}

TEST(LabelCalibration, IsTheSameForAnyNumberOfThreads)
{
  const LabelDistributions network = randomNetwork(5, 5000, 11);
  const std::vector<PointFeatures> features = randomFeatures(5000, 12);
  setNumberOfThreads(1);
  const LabelDistributions one = calibrate(makeCalibration(), network, features);
  setNumberOfThreads(4);
  EXPECT_EQ(calibrate(makeCalibration(), network, features).matrix(), one.matrix());
  setNumberOfThreads(0);
}

TEST(LabelCalibration, RefusesWhatDoesNotFit)
{
  using Change = std::function<void(LabelCalibration&)>;
  const auto expectRefused = [](const std::string& says, const Change& change,
                                int classes = 5, std::size_t points = 10) {
    LabelCalibration calibration = makeExperiencedCalibration();
    change(calibration);
    expectBadParameter(says, [&] {
      calibrate(calibration, randomNetwork(classes, 10, 1), randomFeatures(points, 2));
    });
  };
  const Change none = [](auto&) {};
  expectRefused("of 5 classes: got 4 classes", none, 4);
  expectRefused("10 points, features of 9", none, 5, 9);
  const std::string seen = "'seen' needs 5 fractions at each knot";
  const std::string order = "a feature has two curves, or comes out of order";
  for (const auto& [says, change] : std::vector<std::pair<std::string, Change>>{
           {"bias", [](auto& c) { c.bias.conservativeResize(4); }},
           {"bias", [](auto& c) { c.bias[2] = unknown; }},
           {"-1e6 to 1e6", [](auto& c) { c.bias[1] = -3e38f; }},
           {"sharpness", [](auto& c) { c.sharpness = -0.1f; }},
           {"0 to 1e6", [](auto& c) { c.sharpness = 2e6f; }},
           {"ground label 6", [](auto& c) { c.ground = {6}; }},
           {"curves of height", [](auto& c) { c.curves[0].values(0, 1) = 3e38f; }},
           {"curves of height",
            [](auto& c) { c.curves[0].knots[1] = c.curves[0].knots[0]; }},
           {"curves of distance", [](auto& c) { c.curves[1].values(0, 0) = unknown; }},
           {"curves of level",
            [](auto& c) {
              c.curves[2].knots.resize(1);
              c.curves[2].values.conservativeResize(5, 1);
            }},
           {"curves of level",
            [](auto& c) { c.curves[2].values.conservativeResize(4, 3); }},
           {"curves of red", [](auto& c) { c.curves[4].knots.clear(); }},
           {order, [](auto& c) { std::swap(c.curves[1], c.curves[2]); }},
           {order, [](auto& c) { c.curves.push_back(c.curves.back()); }},
           {seen, [](auto& c) { c.seen.resize(1, Eigen::MatrixXf::Zero(5, 3)); }},
           {seen, [](auto& c) { c.seen[0].conservativeResize(5, 1); }},
           {seen, [](auto& c) { c.seen[1](2, 0) = -0.1f; }},
           {seen, [](auto& c) { c.seen[1](2, 0) = unknown; }},
           {seen, [](auto& c) { c.usual_distance = unknown; }},
           {seen, [](auto& c) { c.usual_distance = 1.5f; }}})
    expectRefused(says, change);
  // Logarithms would come out as probabilities.
  LabelDistributions bad = randomNetwork(5, 10, 1);
  bad.matrix()(2, 7) = -0.5f;
  expectBadInput("of point 7 has a negative or non-finite probability", [&] {
    calibrate(makeExperiencedCalibration(), bad, randomFeatures(10, 2));
  });
}

// By hand: three pixels of class 2 at a quarter of the way, at a knot and beyond the
// last one, one of class 1; two that do not count.
TEST(FeatureHistogram, IsWhereThePixelsOfAClassLie)
{
  LabelDistributions network(5, 6);
  const std::array<Label, 6> labels{2, 2, 2, 1, 2, kUnlabelled};
  const std::array<float, 6> heights{0.25f, 1.0f, 7.0f, -1.0f, unknown, 1.0f};
  std::vector<PointFeatures> features(6);
  for (std::size_t i = 0; i < 6; ++i) {
    if (labels[i] != kUnlabelled)
      network.setLabel(Eigen::Index(i), labels[i], 0.8f);
    features[i][Feature::height] = heights[i];
  }
  Eigen::MatrixXf expected = Eigen::MatrixXf::Zero(5, 3);
  expected.row(0) << 0.25f, 0.0f, 0.0f;
  expected.row(1) << 0.75f / 4.0f, 1.25f / 4.0f, 0.25f;
  const std::vector<float> knots{0.0f, 1.0f, 2.0f};
  EXPECT_TRUE(featureHistogram(Feature::height, knots, network, features)
                  .isApprox(expected, 1e-6f));
  EXPECT_TRUE(featureHistogram(Feature::level, knots, network, features).isZero(0.0f));
}

TEST(FeatureHistogram, DistancesGoFromTheSameToNothingInCommon)
{
  Eigen::MatrixXf left = Eigen::MatrixXf::Zero(2, 2), right = left;
  left(0, 0) = 1.0f;
  right(1, 0) = 1.0f;
  const Eigen::MatrixXf none = Eigen::MatrixXf::Zero(2, 2);
  EXPECT_EQ(histogramDistance({left}, {left}), 0.0);
  EXPECT_EQ(histogramDistance({left}, {right}), 1.0);
  EXPECT_EQ(histogramDistance({left, left}, {left, right}), 0.5);
  EXPECT_EQ(histogramDistance({left, none}, {right, right}), 1.0);
  EXPECT_TRUE(std::isnan(histogramDistance({none}, {left})));
  EXPECT_TRUE(std::isnan(histogramDistance({}, {left})));
}

TEST(DomainShift, IsTheDistanceInUnitsOfTheUsualOne)
{
  const LabelCalibration calibration = makeExperiencedCalibration();
  const LabelDistributions same = randomNetwork(5, 400, 21);
  const std::vector<PointFeatures> places = randomFeatures(400, 22);
  EXPECT_NEAR(domainShift(calibration, same, places), 0.0, 1e-6);
  LabelDistributions other = same;
  for (Eigen::Index i = 0; i < other.size(); ++i)
    other.setLabel(i, 4, 0.9f);
  std::vector<Eigen::MatrixXf> shown;
  for (const ClassCurves& each : calibration.curves)
    shown.push_back(featureHistogram(each.feature, each.knots, other, places));
  const double shift = domainShift(calibration, other, places);
  EXPECT_NEAR(shift, histogramDistance(shown, calibration.seen) / 0.25, 1e-9);
  EXPECT_GT(shift, 1.0);
  EXPECT_TRUE(std::isnan(domainShift(makeCalibration(), same, places)));
}

TEST(LabelCalibrationFile, TakesAnyFeatureInAnyOrder)
{
  const TemporaryFolder folder;
  std::string text = "sharpness: 1\nground: []\nknots:\n";
  for (std::size_t f = feature_count; f-- > 0;)
    text +=
        std::string("  ") + feature_names[f] + ": [0, " + std::to_string(f + 1) + "]\n";
  const LabelCalibration read =
      readCalibration(folder.write("a.yaml", text + "classes: {}\n"), fiveClasses());
  ASSERT_EQ(read.curves.size(), feature_count);
  for (std::size_t f = 0; f < feature_count; ++f) {
    EXPECT_EQ(read.curves[f].feature, Feature(f));
    EXPECT_EQ(read.curves[f].knots[1], float(f + 1));
    EXPECT_EQ(findFeature(nameOf(Feature(f))), Feature(f));
  }
  EXPECT_FALSE(findFeature("smell"));
}

TEST(LabelCalibrationFile, BadOnesAreRefusedWithTheirLine)
{
  const std::string good = "sharpness: 0.5\nground: [road]\nknots:\n"
                           "  height: [0, 1, 2]\nclasses:\n  road:\n"
                           "    bias: 1\n    height: [1, 2, 3]\n  post:\n"
                           "    bias: 2\n"
                           "seen:\n  usual_distance: 0.5\n  height:\n"
                           "    tree: [0, 0.5, 0.5]\n";
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    return readCalibration(folder.write("a.yaml", text), fiveClasses());
  };
  EXPECT_EQ(read(good).curves.at(0).values(1, 2), 3.0f);
  EXPECT_EQ(read(good).fitted, (std::vector<bool>{false, true, false, false, true}));
  EXPECT_EQ(read(good).seen.at(0)(3, 1), 0.5f);
  EXPECT_EQ(read("of: pixels\n" + good).sharpness, 0.5f); // written by some versions
  for (const auto& [from, to, says] : std::vector<std::array<std::string, 3>>{
           {"  post:", "  mast:", "line 9: class 'mast' is not in the label set"},
           {"[road]", "[rode]", "line 2: class 'rode' is not in the label set"},
           {"    bias: 2", "    bios: 2", "line 10: key 'bios' is not known"},
           {"  height: [0", "  heights: [0", "line 4: key 'heights' is not known"},
           {"sharpness: 0.5", "sharpness: 0.5\nblunt: 1", "line 2: key 'blunt'"},
           {"[1, 2, 3]", "[1, 2]", "line 8: height has 2 values for 3 knots"},
           {"height: [1", "level: [1", "line 8: key 'level' is not known"},
           {"[0, 1, 2]", "[0, 2, 2]", "line 4: expected two or more rising knots"},
           {"[0, 1, 2]", "[0]", "line 4: expected two or more rising knots"},
           {"[0, 1, 2]", "[0, 1, .nan]", "line 4: "},
           {"sharpness: 0.5", "sharpness: -1", "line 1: sharpness is -1"},
           {"sharpness: 0.5", "of: cliques\nsharpness: 0.5",
            "line 1: is a calibration of 'cliques', expected of pixels"},
           {"bias: 2", "bias: much", "line 10: "},
           {"[0, 0.5, 0.5]", "[0, 1]", "line 14: 2 values for 3 knots"},
           {"tree", "three", "line 14: class 'three' is not in the label set"},
           {"usual_distance: 0.5", "usual_distance: 2", "a usual distance of 0 to 1"},
           {"  usual_distance: 0.5\n", "", "usual_distance"},
           {"0.5\n  height", "0.5\n  heights", "height"},
           {"sharpness: 0.5\n", "", "sharpness"},
           {"ground: [road]\n", "", "ground"}}) {
    std::string text = good;
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    const std::string message =
        thrownMessage<BadInputException>([&, &bad = text] { read(bad); });
    EXPECT_TRUE(holds(message, says)) << text;
    EXPECT_TRUE(holds(message, folder.path("a.yaml"))) << text;
  }
}

} // namespace
} // namespace pcl_semantic
