// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/labelling/calibration_fit.h>

#include "calibration_term.h"
#include "core/fail.h"
#include "core/parallel_guard.h"
#include "lbfgs.h"

#include <functional>
#include <map>
#include <set>

namespace pcl_semantic {

namespace {

std::vector<float>
streetKnotsOf(Feature feature)
{
  switch (feature) {
  case Feature::height:
  case Feature::lowest:
    return {-0.5f, -0.15f, 0.0f, 0.1f, 0.2f, 0.4f, 0.8f, 1.4f, 2.0f, 3.0f, 5.0f};
  case Feature::distance:
    return {5.0f, 10.0f, 15.0f, 20.0f, 30.0f, 40.0f};
  case Feature::level:
    return {0.0f, 0.3f, 0.6f, 0.85f, 1.0f};
  case Feature::side:
    return {0.0f, 2.0f, 4.0f, 6.0f, 9.0f, 13.0f, 20.0f};
  case Feature::extent:
    return {0.0f, 0.3f, 0.7f, 1.2f, 2.0f, 3.0f, 5.0f};
  case Feature::brightness:
    return {0.05f, 0.15f, 0.25f, 0.35f, 0.5f, 0.7f, 0.9f};
  case Feature::red:
  case Feature::green:
    return {0.24f, 0.28f, 0.31f, 0.33f, 0.35f, 0.38f, 0.44f};
  }
  return {};
}

} // namespace

const std::vector<Feature>&
pixelFeatures()
{
  static const std::vector<Feature> features{Feature::height, Feature::distance,
                                             Feature::level};
  return features;
}

const std::vector<Feature>&
cliqueFeatures()
{
  static const std::vector<Feature> features{
      Feature::height, Feature::distance,   Feature::level, Feature::side,
      Feature::lowest, Feature::brightness, Feature::red,   Feature::green};
  return features;
}

std::vector<FeatureKnots>
streetKnots(const std::vector<Feature>& features)
{
  const std::set<Feature> in_order(features.begin(), features.end());
  std::vector<FeatureKnots> all;
  for (const Feature feature : in_order)
    all.push_back({feature, streetKnotsOf(feature)});
  return all;
}

void
CalibrationSamples::validate() const
{
  const std::size_t count = truth.size();
  if (features.size() != count || std::size_t(network.size()) != count)
    fail<InvalidParameterException>("calibration: ", count, " labels for ",
                                    network.size(), " distributions and ",
                                    features.size(), " lists of features");
  for (const auto& [size, called] : {std::pair(weights.size(), " weights"),
                                     std::pair(sequences.size(), " sequences")})
    if (size != 0 && size != count)
      fail<InvalidParameterException>("calibration: ", count, " labels for ", size,
                                      called);
  for (const float weight : weights)
    if (!(weight > 0.0f && std::isfinite(weight)))
      fail<InvalidParameterException>("calibration: a weight is ", weight,
                                      ", expected more than 0");
  for (const int sequence : sequences)
    if (sequence < 0)
      fail<InvalidParameterException>("calibration: a sequence is ", sequence,
                                      ", expected 0 or more");
  for (const Label label : truth)
    if (label > network.classes())
      fail<InvalidParameterException>("calibration: ground truth ", int(label), " of ",
                                      network.classes(), " classes");
}

void
CalibrationOptions::validate() const
{
  for (const auto& [name, value, most] :
       {std::tuple("balance", balance, 1.0), std::tuple("shrinkage", shrinkage, 1.0),
        std::tuple("bias_penalty", bias_penalty, 1e6),
        std::tuple("curve_penalty", curve_penalty, 1e6)})
    if (!(value >= 0.0 && value <= most))
      fail<InvalidParameterException>(name, " is ", value, ", expected 0 to ", most);
  for (const auto& [feature, knots] : curves)
    if (!areKnots(knots))
      fail<InvalidParameterException>("knots of ", nameOf(feature),
                                      ": expected two or more that rise");
  if (!areInOrder(curves))
    fail<InvalidParameterException>("knots: a feature comes twice, or out of order");
  if (iterations < 1)
    fail<InvalidParameterException>("iterations is ", iterations,
                                    ", expected 1 or more");
}

namespace {

// Row of the design matrix: a constant and the two weights on each curve. Class scores
// are linear in it, plus the sharpness term.
struct SparseRow {
  std::array<int, 1 + 2 * feature_count> columns{};
  std::array<double, 1 + 2 * feature_count> values{};
  int count = 0;

  void
  add(int column, double value)
  {
    columns[std::size_t(count)] = column;
    values[std::size_t(count++)] = value;
  }
};

bool
counts(const CalibrationSamples& samples, std::size_t i)
{
  return samples.truth[i] != kUnlabelled &&
         samples.network.mapLabel(Eigen::Index(i)) != kUnlabelled;
}

double
weightOf(const CalibrationSamples& samples, std::size_t i)
{
  return samples.weights.empty() ? 1.0 : double(samples.weights[i]);
}

// Weights of the chosen samples, with a sum of 1: equal for every sequence, and within
// it number of samples to the power of 1 - balance for every class.
std::vector<double>
balancedWeights(const CalibrationSamples& samples,
                const std::vector<std::size_t>& chosen, double balance)
{
  const auto sequenceOf = [&](std::size_t i) {
    return samples.sequences.empty() ? 0 : samples.sequences[i];
  };
  std::map<int, std::map<Label, double>> numbers;
  for (const std::size_t i : chosen)
    numbers[sequenceOf(i)][samples.truth[i]] += weightOf(samples, i);
  std::map<int, double> sums;
  for (const auto& [sequence, classes] : numbers)
    for (const auto& [label, number] : classes)
      sums[sequence] += std::pow(number, 1.0 - balance);
  std::vector<double> weights;
  weights.reserve(chosen.size());
  for (const std::size_t i : chosen) {
    const int sequence = sequenceOf(i);
    const double number = numbers[sequence][samples.truth[i]];
    weights.push_back(weightOf(samples, i) * std::pow(number, -balance) /
                      (sums[sequence] * double(numbers.size())));
  }
  return weights;
}

SparseRow
rowOf(const CalibrationOptions& options, const PointFeatures& features)
{
  SparseRow row;
  row.add(0, 1.0);
  int first = 1;
  for (const auto& [feature, knots] : options.curves) {
    const CurvePosition position = positionOn(knots, features[feature]);
    if (position.first >= 0) {
      row.add(first + position.first, 1.0 - position.fraction);
      row.add(first + position.first + 1, position.fraction);
    }
    first += int(knots.size());
  }
  return row;
}

// The negative penalised likelihood of a parameter vector: the sharpness, then K values
// per column, where K is the number of fitted classes.
class Likelihood {
public:
  Likelihood(const CalibrationSamples& samples, const CalibrationOptions& options)
      : bias_penalty_(options.bias_penalty), curve_penalty_(options.curve_penalty)
  {
    std::vector<std::size_t> chosen;
    std::set<Label> labels;
    for (std::size_t i = 0; i < samples.truth.size(); ++i)
      if (counts(samples, i)) {
        chosen.push_back(i);
        labels.insert(samples.truth[i]);
      }
    labels_.assign(labels.begin(), labels.end());
    for (const FeatureKnots& each : options.curves)
      columns_ += int(each.knots.size());
    std::array<int, 256> number{};
    for (std::size_t k = 0; k < labels_.size(); ++k)
      number[labels_[k]] = int(k);
    weights_ = balancedWeights(samples, chosen, options.balance);
    logs_.resize(classes(), Eigen::Index(chosen.size()));
    std::vector<float> logs(std::size_t(samples.network.classes()));
    for (const std::size_t i : chosen) {
      const auto column = Eigen::Index(rows_.size());
      clampedLog(samples.network.column(Eigen::Index(i)), samples.network.classes(),
                 logs.data());
      for (int k = 0; k < classes(); ++k)
        logs_(k, column) = logs[labels_[std::size_t(k)] - 1u];
      truth_.push_back(number[samples.truth[i]]);
      rows_.push_back(rowOf(options, samples.features[i]));
    }
  }

  int
  classes() const
  {
    return int(labels_.size());
  }

  int
  size() const
  {
    return 1 + columns_ * classes();
  }

  double
  operator()(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const
  {
    const std::size_t chunks = (rows_.size() + chunk - 1) / chunk;
    const auto dims = static_cast<Eigen::Index>(size());
    Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(dims, Eigen::Index(chunks));
    std::vector<double> losses(chunks);
    ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 1)
    for (std::size_t c = 0; c < chunks; ++c)
      guard.run([&] {
        losses[c] = chunkOf(c * chunk, std::min((c + 1) * chunk, rows_.size()),
                            x.data(), slopes.col(Eigen::Index(c)).data());
      });
    guard.rethrow();
    gradient.setZero(dims);
    double loss = 0.0;
    for (std::size_t c = 0; c < chunks; ++c) {
      loss += losses[c];
      gradient += slopes.col(Eigen::Index(c));
    }
    return loss + addPenalty(x.data(), gradient.data());
  }

  LabelCalibration
  calibration(const double* x, int all_classes, const CalibrationOptions& options) const
  {
    LabelCalibration result = LabelCalibration::identity(all_classes);
    result.fitted.assign(result.fitted.size(), false);
    result.sharpness = static_cast<float>(x[0]);
    const Eigen::Map<const Eigen::MatrixXd> values(x + 1, classes(), columns_);
    int first = 1;
    for (const auto& [feature, knots] : options.curves) {
      const auto count = static_cast<Eigen::Index>(knots.size());
      ClassCurves curves{feature, knots, Eigen::MatrixXf::Zero(all_classes, count)};
      for (int k = 0; k < classes(); ++k)
        curves.values.row(labels_[std::size_t(k)] - 1) =
            values.block(k, first, 1, count).cast<float>();
      result.curves.push_back(std::move(curves));
      first += int(count);
    }
    for (int k = 0; k < classes(); ++k) {
      result.fitted[labels_[std::size_t(k)] - 1u] = true;
      result.bias[labels_[std::size_t(k)] - 1] = static_cast<float>(values(k, 0));
    }
    return result;
  }

private:
  // Chunks of a fixed size, added in order, make the sums independent of the number of
  // threads.
  static constexpr std::size_t chunk = 4096;

  double
  chunkOf(std::size_t begin, std::size_t end, const double* x, double* gradient) const
  {
    const Eigen::Map<const Eigen::MatrixXd> values(x + 1, classes(), columns_);
    Eigen::Map<Eigen::MatrixXd> slope(gradient + 1, classes(), columns_);
    Eigen::VectorXd scores(classes());
    double loss = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      const SparseRow& row = rows_[i];
      const auto logs = logs_.col(Eigen::Index(i));
      scores = x[0] * logs;
      for (int j = 0; j < row.count; ++j)
        scores += row.values[std::size_t(j)] * values.col(row.columns[std::size_t(j)]);
      const double largest = scores.maxCoeff();
      const double of_truth = scores[truth_[i]] - largest;
      scores = (scores.array() - largest).exp();
      const double sum = scores.sum();
      loss += weights_[i] * (std::log(sum) - of_truth);
      scores *= weights_[i] / sum;
      scores[truth_[i]] -= weights_[i];
      gradient[0] += scores.dot(logs);
      for (int j = 0; j < row.count; ++j)
        slope.col(row.columns[std::size_t(j)]) += row.values[std::size_t(j)] * scores;
    }
    return loss;
  }

  double
  addPenalty(const double* x, double* gradient) const
  {
    double penalty = 0.0;
    for (int i = 1; i < size(); ++i) {
      const double weight = i <= classes() ? bias_penalty_ : curve_penalty_;
      penalty += weight * x[i] * x[i];
      gradient[i] += 2.0 * weight * x[i];
    }
    return penalty;
  }

  std::vector<Label> labels_; // the fitted classes
  Eigen::MatrixXd logs_;      // K x N
  std::vector<SparseRow> rows_;
  std::vector<int> truth_; // 0..K-1
  std::vector<double> weights_;
  int columns_ = 1; // the constant, then the knots
  double bias_penalty_, curve_penalty_;
};

} // namespace

LabelCalibration
fitCalibration(const CalibrationSamples& samples, const CalibrationOptions& options)
{
  options.validate();
  samples.validate();
  const Likelihood likelihood(samples, options);
  if (likelihood.classes() < 2)
    fail<BadInputException>(
        "calibration: expected ground truth of two classes or more");
  Eigen::VectorXd start = Eigen::VectorXd::Zero(likelihood.size());
  start[0] = 1.0;
  constexpr double tolerance = 1e-6;
  Eigen::VectorXd best =
      minimizeConvex(std::cref(likelihood), start, options.iterations, tolerance);
  if (best[0] < 0.0) { // a mostly wrong network: fit without it
    const auto blind = [&](const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
      const double loss = likelihood(x, gradient);
      gradient[0] = 0.0;
      return loss;
    };
    start[0] = 0.0;
    best = minimizeConvex(blind, start, options.iterations, tolerance);
  }
  best.tail(best.size() - 1) *= 1.0 - options.shrinkage;
  LabelCalibration result =
      likelihood.calibration(best.data(), samples.network.classes(), options);
  result.of = samples.of;
  return result;
}

} // namespace pcl_semantic
