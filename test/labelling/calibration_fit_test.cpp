// SPDX-License-Identifier: BSD-3-Clause
#include "labelling/lbfgs.h"
#include "support/plain_calibration.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/labelling/calibration_fit.h>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <functional>
#include <map>

namespace pcl_semantic {
namespace {

// Truth by chance as a calibration has it.
CalibrationSamples
drawnFrom(const LabelCalibration& calibration, std::size_t count, unsigned seed)
{
  CalibrationSamples samples;
  samples.network = randomNetwork(calibration.classes(), Eigen::Index(count), seed);
  samples.features = randomFeatures(count, seed + 1);
  const Eigen::MatrixXd chances =
      plainCalibrate(calibration, samples.network, samples.features);
  std::mt19937 random(seed + 2);
  for (Eigen::Index i = 0; i < chances.cols(); ++i) {
    const Eigen::VectorXd column = chances.col(i);
    std::discrete_distribution<int> draw(column.data(), column.data() + column.size());
    samples.truth.push_back(Label(draw(random) + 1));
  }
  return samples;
}

// Four classes, of which the truth has 1, 2 and 4; some samples do not count.
CalibrationSamples
someSamples(std::size_t count)
{
  CalibrationSamples samples = drawnFrom(randomCalibration(4, 5), count, 6);
  for (Label& label : samples.truth)
    label = label == 3 ? 1 : label;
  for (std::size_t i = 0; i < count; i += 10) {
    samples.truth[i] = kUnlabelled;
    samples.network.matrix().col(Eigen::Index(i) + 3).setZero();
  }
  samples.truth[3] = 3; // no prediction: no sample of class 3
  return samples;
}

// What fitCalibration() makes small, sample by sample, before it shrinks anything.
double
plainLoss(const LabelCalibration& calibration, const CalibrationSamples& samples,
          const CalibrationOptions& options)
{
  const auto counts = [&](std::size_t i) {
    return samples.truth[i] != kUnlabelled &&
           samples.network.matrix().col(Eigen::Index(i)).sum() > 0.0f;
  };
  const auto sequenceOf = [&](std::size_t i) {
    return samples.sequences.empty() ? 0 : samples.sequences[i];
  };
  std::map<Label, double> sizes;
  std::map<int, std::map<Label, double>> in_sequence;
  for (std::size_t i = 0; i < samples.truth.size(); ++i)
    if (counts(i)) {
      ++sizes[samples.truth[i]];
      ++in_sequence[sequenceOf(i)][samples.truth[i]];
    }
  std::map<int, double> losses, weights;
  for (std::size_t i = 0; i < samples.truth.size(); ++i) {
    if (!counts(i))
      continue;
    double total = 0.0, of_truth = 0.0;
    for (const auto& [label, size] : sizes) {
      const double weight = plainWeight(
          calibration, label - 1, samples.network.column(Eigen::Index(i))[label - 1],
          samples.features[i]);
      total += weight;
      of_truth += label == samples.truth[i] ? weight : 0.0;
    }
    const int sequence = sequenceOf(i);
    const double weight =
        std::pow(in_sequence[sequence][samples.truth[i]], -options.balance);
    losses[sequence] -= weight * std::log(of_truth / total);
    weights[sequence] += weight;
  }
  double loss = 0.0;
  for (const auto& [sequence, of_sequence] : losses)
    loss += of_sequence / weights[sequence] / double(losses.size());
  double curves = 0.0;
  for (const ClassCurves& each : calibration.curves)
    curves += each.values.cast<double>().squaredNorm();
  return loss + options.bias_penalty * calibration.bias.cast<double>().squaredNorm() +
         options.curve_penalty * curves;
}

// All numbers of the fitted classes; the sharpness is the first.
std::vector<float*>
parametersOf(LabelCalibration& calibration)
{
  std::vector<float*> parameters{&calibration.sharpness};
  for (int l = 0; l < calibration.classes(); ++l) {
    if (!calibration.fitted[std::size_t(l)])
      continue;
    parameters.push_back(&calibration.bias[l]);
    for (ClassCurves& curves : calibration.curves)
      for (Eigen::Index k = 0; k < curves.values.cols(); ++k)
        parameters.push_back(&curves.values(l, k));
  }
  return parameters;
}

// EXPECTs more loss a step to either side of each parameter.
void
expectMinimum(LabelCalibration calibration, const CalibrationSamples& samples,
              const CalibrationOptions& options)
{
  const double least = plainLoss(calibration, samples, options);
  const std::vector<float*> parameters = parametersOf(calibration);
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const float value = *parameters[p];
    for (const float step : {-0.02f, 0.02f}) {
      *parameters[p] = value + step;
      if (p == 0 && *parameters[p] < 0.0f)
        continue; // no sharpness
      EXPECT_GT(plainLoss(calibration, samples, options), least) << p << " " << step;
    }
    *parameters[p] = value;
  }
}

// Sequences 0, 2 and 5 with 1, 2 and 3 parts in 6 of the samples.
std::vector<int>
threeSequences(std::size_t count)
{
  std::vector<int> sequences;
  for (std::size_t i = 0; i < count; ++i)
    sequences.push_back(std::array{0, 2, 2, 5, 5, 5}[i % 6]);
  return sequences;
}

CalibrationOptions
unshrunk()
{
  CalibrationOptions options;
  options.shrinkage = 0.0;
  return options;
}

TEST(CalibrationFit, IsTheMinimumOfThePenalisedLoss)
{
  CalibrationSamples samples = someSamples(500);
  for (const double balance : {0.0, 0.5, 1.0}) {
    samples.sequences = threeSequences(balance == 1.0 ? 0 : 500);
    CalibrationOptions options = unshrunk();
    options.balance = balance;
    options.curves = streetKnots(everyFeature());
    const LabelCalibration calibration = fitCalibration(samples, options);
    ASSERT_EQ(calibration.curves.size(), options.curves.size());
    for (std::size_t i = 0; i < options.curves.size(); ++i) {
      EXPECT_EQ(calibration.curves[i].feature, options.curves[i].feature);
      EXPECT_EQ(calibration.curves[i].knots, options.curves[i].knots);
    }
    expectMinimum(calibration, samples, options);
  }
}

TEST(CalibrationFit, StreetKnotsComeInOrderAndOnce)
{
  const auto all = streetKnots({Feature::green, Feature::side, Feature::green});
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].feature, Feature::side);
  EXPECT_EQ(all[1].feature, Feature::green);
  CalibrationOptions options;
  options.curves = streetKnots(everyFeature());
  EXPECT_EQ(options.curves.size(), feature_count);
  EXPECT_NO_THROW(options.validate());
  for (const auto& curve : options.curves) {
    const bool is_fraction =
        curve.feature == Feature::level || curve.feature == Feature::brightness ||
        curve.feature == Feature::red || curve.feature == Feature::green;
    EXPECT_LE(curve.knots.back(), is_fraction ? 1.0f : 50.0f) << int(curve.feature);
  }
}

TEST(CalibrationFit, FitsWithoutCurves)
{
  const CalibrationSamples samples = someSamples(1000);
  CalibrationOptions options = unshrunk();
  options.curves.clear();
  const LabelCalibration calibration = fitCalibration(samples, options);
  EXPECT_TRUE(calibration.curves.empty());
  expectMinimum(calibration, samples, options);
}

TEST(CalibrationFit, FindsTheCalibrationThatTruthWasDrawnFrom)
{
  const LabelCalibration known = randomCalibration(4, 21);
  CalibrationOptions options = unshrunk();
  options.balance = 0.0; // others weigh the classes, which moves biases
  options.bias_penalty = options.curve_penalty = 1e-6;
  options.curves.clear();
  for (const ClassCurves& curves : known.curves)
    options.curves.push_back({curves.feature, curves.knots});
  const LabelCalibration found = fitCalibration(drawnFrom(known, 40000, 22), options);
  EXPECT_NEAR(found.sharpness, known.sharpness, 0.02f);
  // Parameters that make no difference are free, so probabilities are compared, there
  // and elsewhere.
  const LabelDistributions network = randomNetwork(4, 5000, 31);
  const std::vector<PointFeatures> places = randomFeatures(5000, 32);
  const Eigen::MatrixXd wanted = plainCalibrate(known, network, places);
  const auto difference = [&](const LabelDistributions& other) {
    return (other.matrix().cast<double>() - wanted).cwiseAbs().mean();
  };
  EXPECT_LT(difference(calibrate(found, network, places)), 0.01);
  EXPECT_GT(difference(network), 0.05);
}

TEST(CalibrationFit, ClassesWithoutTruthAreNotFitted)
{
  const LabelCalibration calibration = fitCalibration(someSamples(500), {});
  EXPECT_EQ(calibration.fitted, (std::vector<bool>{true, true, false, true}));
  EXPECT_EQ(calibration.bias[2], 0.0f);
  ASSERT_FALSE(calibration.curves.empty());
  EXPECT_TRUE(calibration.curves[0].values.row(2).isZero(0.0f));
  EXPECT_TRUE(calibration.ground.empty());
}

TEST(CalibrationFit, ANetworkThatIsMostlyWrongIsNotHeard)
{
  CalibrationSamples samples;
  samples.network = randomNetwork(3, 600, 41);
  samples.features = randomFeatures(600, 42);
  for (Eigen::Index i = 0; i < 600; ++i) {
    Eigen::Index least;
    samples.network.matrix().col(i).minCoeff(&least);
    samples.truth.push_back(Label(least + 1));
  }
  const LabelCalibration calibration = fitCalibration(samples, unshrunk());
  EXPECT_EQ(calibration.sharpness, 0.0f);
  EXPECT_NO_THROW(calibrate(calibration, samples.network, samples.features));
  expectMinimum(calibration, samples, unshrunk());
}

TEST(CalibrationFit, ShrinkageScalesEverythingButTheSharpness)
{
  const CalibrationSamples samples = someSamples(500);
  LabelCalibration whole = fitCalibration(samples, unshrunk());
  CalibrationOptions options;
  options.shrinkage = 0.25;
  LabelCalibration shrunk = fitCalibration(samples, options);
  const std::vector<float*> expected = parametersOf(whole),
                            found = parametersOf(shrunk);
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_EQ(*found[0], *expected[0]);
  for (std::size_t i = 1; i < found.size(); ++i)
    EXPECT_NEAR(*found[i], 0.75f * *expected[i], 1e-6f);
}

// EXPECTs the parameters of two fits within 1e-3.
void
expectNear(LabelCalibration one, LabelCalibration other)
{
  const std::vector<float*> a = parametersOf(one), b = parametersOf(other);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_NEAR(*a[i], *b[i], 1e-3f) << i;
}

void
appendCopy(CalibrationSamples& samples, std::size_t i, int sequence)
{
  const Eigen::Index end = samples.network.size();
  samples.network.matrix().conservativeResize(samples.network.classes(), end + 1);
  samples.network.matrix().col(end) = samples.network.matrix().col(Eigen::Index(i));
  samples.features.push_back(PointFeatures(samples.features[i]));
  samples.truth.push_back(Label(samples.truth[i]));
  samples.sequences.push_back(sequence);
}

// The longer of two sequences is the shorter one, twice: as if it were but once.
TEST(CalibrationFit, EverySequenceCountsAlike)
{
  constexpr std::size_t count = 300, first = 60;
  CalibrationSamples samples = someSamples(count), longer;
  for (std::size_t i = 0; i < count; ++i)
    samples.sequences.push_back(i < first ? 0 : 1);
  longer = samples;
  for (std::size_t i = first; i < count; ++i)
    appendCopy(longer, i, 1);
  const LabelCalibration one = fitCalibration(samples, {});
  expectNear(one, fitCalibration(longer, {}));
  longer.sequences.clear();
  EXPECT_GT((fitCalibration(longer, {}).bias - one.bias).norm(), 1e-2f);
}

TEST(CalibrationFit, AWeightCountsASampleSoOften)
{
  CalibrationSamples weighted = someSamples(300), repeated = weighted;
  weighted.weights.assign(300, 1.0f);
  for (std::size_t i = 0; i < 300; i += 3) {
    weighted.weights[i] = 3.0f;
    appendCopy(repeated, i, 0);
    appendCopy(repeated, i, 0);
  }
  repeated.sequences.clear();
  const LabelCalibration one = fitCalibration(weighted, {});
  expectNear(one, fitCalibration(repeated, {}));
  weighted.weights.clear();
  EXPECT_GT((fitCalibration(weighted, {}).bias - one.bias).norm(), 1e-2f);
}

TEST(CalibrationFit, IsTheSameForAnyNumberOfThreads)
{
  const CalibrationSamples samples = someSamples(20000);
  const auto parameters = [&](int threads) {
    setNumberOfThreads(threads);
    LabelCalibration calibration = fitCalibration(samples, {});
    std::vector<float> values;
    for (const float* const value : parametersOf(calibration))
      values.push_back(*value);
    return values;
  };
  const std::vector<float> one = parameters(1);
  EXPECT_EQ(parameters(4), one);
  setNumberOfThreads(0);
}

TEST(CalibrationFit, RefusesBadSamples)
{
  using Change = std::function<void(CalibrationSamples&)>;
  const auto fitChanged = [](const Change& change) {
    CalibrationSamples samples = someSamples(100);
    change(samples);
    fitCalibration(samples, {});
  };
  for (const auto& [change, says] : std::vector<std::pair<Change, std::string>>{
           {[](auto& s) { s.truth.pop_back(); }, "99 labels for 100"},
           {[](auto& s) { s.features.pop_back(); }, "99 lists"},
           {[](auto& s) { s.weights.assign(99, 1.0f); }, "99 weights"},
           {[](auto& s) { s.weights.assign(100, 0.0f); }, "weight is 0"},
           {[](auto& s) { s.sequences.assign(99, 0); }, "99 sequences"},
           {[](auto& s) { s.sequences.assign(100, -1); }, "sequence is -1"},
           {[](auto& s) { s.truth[5] = 5; }, "truth 5 of 4 classes"}})
    expectBadParameter(says, [&, &how = change] { fitChanged(how); });
  for (const Change& change :
       {Change([](auto& s) { s.truth.assign(100, 2); }),
        Change([](auto& s) { s.truth.assign(100, kUnlabelled); }),
        Change([](auto& s) { s.network.matrix().setZero(); }),
        Change([](auto& s) { s = {}; })})
    expectBadInput("expected ground truth of two classes or more",
                   [&] { fitChanged(change); });
}

TEST(CalibrationFit, RefusesBadOptions)
{
  using Change = std::function<void(CalibrationOptions&)>;
  for (const auto& [change, says] : std::vector<std::pair<Change, std::string>>{
           {[](auto& o) { o.balance = 1.1; }, "balance is 1.1"},
           {[](auto& o) { o.shrinkage = -0.1; }, "shrinkage is -0.1"},
           {[](auto& o) { o.bias_penalty = -1; }, "bias_penalty"},
           {[](auto& o) { o.curve_penalty = std::nan(""); }, "curve_penalty"},
           {[](auto& o) { o.iterations = 0; }, "iterations is 0"},
           {[](auto& o) { o.curves[0].knots.clear(); }, "knots of height"},
           {[](auto& o) { o.curves[0].knots = {1.0f}; }, "knots of height"},
           {[](auto& o) { o.curves[2].knots.assign(2, 0.0f); }, "knots of level"},
           {[](auto& o) { std::swap(o.curves[0], o.curves[1]); },
            "a feature comes twice, or out of order"}}) {
    CalibrationOptions options;
    change(options);
    expectBadParameter(says, [&] { fitCalibration(someSamples(100), options); });
  }
}

TEST(MinimizeConvex, SolvesAQuadraticAsEigenDoes)
{
  constexpr int size = 30;
  std::mt19937 random(51);
  std::normal_distribution<double> normal;
  const auto any = [&] { return normal(random); };
  const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(size, size, any);
  const Eigen::MatrixXd matrix =
      root * root.transpose() + 0.5 * Eigen::MatrixXd::Identity(size, size);
  const Eigen::VectorXd right = Eigen::VectorXd::NullaryExpr(size, any);
  const Eigen::VectorXd found = minimizeConvex(
      [&](const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
        gradient = matrix * x - right;
        return 0.5 * x.dot(matrix * x) - right.dot(x);
      },
      Eigen::VectorXd::Constant(size, 3.0), 1000, 1e-7);
  const Eigen::VectorXd exact = matrix.ldlt().solve(right);
  EXPECT_GT(exact.norm(), 0.1);
  EXPECT_LT((found - exact).norm(), 1e-6); // 1e-7 sqrt(30) / 0.5
}

TEST(MinimizeConvex, StaysWhereItIsBest)
{
  const Eigen::VectorXd best = Eigen::VectorXd::LinSpaced(4, -1.0, 2.0);
  int calls = 0;
  const auto function = [&](const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
    ++calls;
    gradient = 2.0 * (x - best);
    return (x - best).squaredNorm();
  };
  EXPECT_EQ(minimizeConvex(function, best, 10, 1e-9), best);
  EXPECT_EQ(calls, 1);
}

} // namespace
} // namespace pcl_semantic
