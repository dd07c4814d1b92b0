// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/labelling/label_calibration.h>

#include "core/fail.h"
#include "core/probabilities.h"
#include "files/yaml_config.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <omp.h>

namespace pcl_semantic {

namespace {

// Lower clamp of a network's probabilities: the size of smaller ones carries no
// information.
constexpr float min_probability = 1e-4f;

/** \brief The two knots around a value, and its fraction between them. */
struct CurvePosition {
  int first = -1; ///< -1: unknown, no curve
  float fraction = 0.0f;
};

/** \brief Whether there are at least two knots, and they rise. */
bool
areKnots(const std::vector<float>& knots)
{
  bool is_fine = knots.size() > 1;
  for (std::size_t i = 0; i < knots.size(); ++i)
    is_fine &= std::isfinite(knots[i]) && (i == 0 || knots[i] > knots[i - 1]);
  return is_fine;
}

CurvePosition
positionOn(const std::vector<float>& knots, float value)
{
  if (!std::isfinite(value))
    return {};
  const float inside = std::clamp(value, knots.front(), knots.back());
  const auto next = std::upper_bound(knots.begin() + 1, knots.end() - 1, inside);
  const int first = int(next - knots.begin()) - 1;
  return {first,
          (inside - knots[std::size_t(first)]) / (*next - knots[std::size_t(first)])};
}

/** \brief Log of a distribution, clamped from below. */
void
clampedLog(const float* distribution, int classes, float* logs)
{
  for (int l = 0; l < classes; ++l)
    logs[l] = std::log(std::max(distribution[l], min_probability));
}

/** \brief Whether each feature of a list of curves or knots occurs once, in order. */
template <typename Curves>
bool
areInOrder(const Curves& curves)
{
  return std::adjacent_find(curves.begin(), curves.end(),
                            [](const auto& a, const auto& b) {
                              return a.feature >= b.feature;
                            }) == curves.end();
}

// Limit of logarithmic values, so that sums and products of them are finite.
constexpr float max_value = 1e6f;

bool
areSmall(const Eigen::Ref<const Eigen::MatrixXf>& values)
{
  return (values.array().abs() <= max_value).all(); // false for NaN
}

void
requireCurves(const ClassCurves& curves, int classes)
{
  const auto& knots = curves.knots;
  const bool fits = curves.values.rows() == classes &&
                    curves.values.cols() == Eigen::Index(knots.size()) &&
                    areSmall(curves.values);
  if (!fits || !areKnots(knots))
    fail<InvalidParameterException>(
        "calibration: the curves of ", nameOf(curves.feature),
        " need two or more rising knots and ", classes, " values at each, -1e6 to 1e6");
}

void
requireSeen(const LabelCalibration& calibration)
{
  bool fits =
      calibration.seen.empty() || calibration.seen.size() == calibration.curves.size();
  for (std::size_t i = 0; fits && i < calibration.seen.size(); ++i)
    fits = calibration.seen[i].rows() == calibration.classes() &&
           calibration.seen[i].cols() == calibration.curves[i].values.cols() &&
           (calibration.seen[i].array() >= 0.0f).all() && areSmall(calibration.seen[i]);
  if (!fits ||
      !(calibration.usual_distance >= 0.0f && calibration.usual_distance <= 1.0f))
    fail<InvalidParameterException>(
        "calibration: 'seen' needs ", calibration.classes(),
        " fractions at each knot of every curve, and a usual distance of 0 to 1");
}

// Processes one column after the other, with a buffer of L values.
class Calibrator {
public:
  explicit Calibrator(const LabelCalibration& calibration)
      : calibration_(calibration), logs_(calibration.classes())
  {}

  void
  apply(const PointFeatures& features, float* distribution)
  {
    const int classes = calibration_.classes();
    float kept = 0.0f, sum = 0.0f;
    for (int l = 0; l < classes; ++l) {
      sum += distribution[l];
      kept += calibration_.fitted[std::size_t(l)] ? 0.0f : distribution[l];
    }
    if (!(sum > 0.0f) || !(kept < sum))
      return;
    clampedLog(distribution, classes, logs_.data());
    logs_ = calibration_.sharpness * logs_ + calibration_.bias;
    for (const ClassCurves& curves : calibration_.curves) {
      const CurvePosition position = positionOn(curves.knots, features[curves.feature]);
      if (position.first >= 0)
        logs_ += (1.0f - position.fraction) * curves.values.col(position.first) +
                 position.fraction * curves.values.col(position.first + 1);
    }
    distribute(sum - kept, distribution);
  }

private:
  void
  distribute(float mass, float* distribution)
  {
    const int classes = calibration_.classes();
    float largest = -std::numeric_limits<float>::infinity(), total = 0.0f;
    for (int l = 0; l < classes; ++l)
      if (calibration_.fitted[std::size_t(l)])
        largest = std::max(largest, logs_[l]);
    for (int l = 0; l < classes; ++l)
      if (calibration_.fitted[std::size_t(l)])
        total += distribution[l] = std::exp(logs_[l] - largest);
    for (int l = 0; l < classes; ++l)
      if (calibration_.fitted[std::size_t(l)])
        distribution[l] *= mass / total;
  }

  const LabelCalibration& calibration_;
  Eigen::VectorXf logs_;
};

} // namespace

LabelCalibration
LabelCalibration::identity(int classes)
{
  LabelCalibration calibration;
  calibration.fitted.assign(std::size_t(classes), true);
  calibration.bias = Eigen::VectorXf::Zero(classes);
  return calibration;
}

void
LabelCalibration::validate() const
{
  if (bias.size() != classes() || !areSmall(bias) ||
      !(sharpness >= 0.0f && sharpness <= max_value))
    fail<InvalidParameterException>(
        "calibration: expected a bias for each of ", classes(),
        " classes, -1e6 to 1e6, and a sharpness of 0 to 1e6");
  for (const Label label : ground)
    if (label < 1 || label > classes())
      fail<InvalidParameterException>("calibration: ground label ", int(label),
                                      " is not 1 to ", classes());
  for (const ClassCurves& each : curves)
    requireCurves(each, classes());
  if (!areInOrder(curves))
    fail<InvalidParameterException>(
        "calibration: a feature has two curves, or comes out of order");
  requireSeen(*this);
}

LabelDistributions
calibrate(const LabelCalibration& calibration, const LabelDistributions& distributions,
          const std::vector<PointFeatures>& features)
{
  calibration.validate();
  if (distributions.classes() != calibration.classes() ||
      (!features.empty() && Eigen::Index(features.size()) != distributions.size()))
    fail<InvalidParameterException>("calibration of ", calibration.classes(),
                                    " classes: got ", distributions.classes(),
                                    " classes of ", distributions.size(),
                                    " points, features of ", features.size());
  requireProbabilities(distributions);
  LabelDistributions result = distributions;
  const auto threads = static_cast<std::size_t>(omp_get_max_threads());
  std::vector<Calibrator> calibrators(threads, Calibrator(calibration));
#pragma omp parallel
  {
    Calibrator& calibrator = calibrators[std::size_t(omp_get_thread_num())];
#pragma omp for
    for (Eigen::Index i = 0; i < result.size(); ++i)
      calibrator.apply(features.empty() ? PointFeatures{} : features[std::size_t(i)],
                       result.column(i));
  }
  return result;
}

Eigen::MatrixXf
featureHistogram(Feature feature, const std::vector<float>& knots,
                 const LabelDistributions& distributions,
                 const std::vector<PointFeatures>& features)
{
  Eigen::MatrixXd sums =
      Eigen::MatrixXd::Zero(distributions.classes(), Eigen::Index(knots.size()));
  constexpr Eigen::Index enough = 100000; // pixels; more do not change the result
  const Eigen::Index step = 1 + distributions.size() / enough;
  for (Eigen::Index i = 0; i < distributions.size(); i += step) {
    const Label label = distributions.mapLabel(i);
    const CurvePosition position = positionOn(knots, features[std::size_t(i)][feature]);
    if (label == kUnlabelled || position.first < 0)
      continue;
    sums(label - 1, position.first) += 1.0 - position.fraction;
    sums(label - 1, position.first + 1) += position.fraction;
  }
  const double sum = sums.sum();
  return (sums / (sum > 0.0 ? sum : 1.0)).cast<float>();
}

double
histogramDistance(const std::vector<Eigen::MatrixXf>& histograms,
                  const std::vector<Eigen::MatrixXf>& others)
{
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < std::min(histograms.size(), others.size()); ++i)
    if (!histograms[i].isZero(0.0f) && !others[i].isZero(0.0f)) {
      sum += 0.5 * double((histograms[i] - others[i]).cwiseAbs().sum());
      ++count;
    }
  return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

double
domainShift(const LabelCalibration& calibration,
            const LabelDistributions& distributions,
            const std::vector<PointFeatures>& features)
{
  if (calibration.seen.empty() || !(calibration.usual_distance > 0.0f))
    return std::numeric_limits<double>::quiet_NaN();
  std::vector<Eigen::MatrixXf> histograms;
  for (const ClassCurves& curves : calibration.curves)
    histograms.push_back(
        featureHistogram(curves.feature, curves.knots, distributions, features));
  return histogramDistance(histograms, calibration.seen) /
         double(calibration.usual_distance);
}

namespace {

Label
labelOf(const YamlMap& map, const std::string& key, const std::string& name,
        const LabelSet& label_set)
{
  const Label label = label_set.find(name);
  if (label == kUnlabelled)
    fail<BadInputException>(map.where(key), ": class '", name,
                            "' is not in the label set");
  return label;
}

// Reads one value per knot of a curve. \a called is a prefix of the error message.
Eigen::RowVectorXf
readValues(const YamlMap& map, const std::string& key, const ClassCurves& curves,
           const std::string& called)
{
  const auto values = map.require<std::vector<double>>(key);
  if (values.size() != curves.knots.size())
    fail<BadInputException>(map.where(key), ": ", called, values.size(), " values for ",
                            curves.knots.size(), " knots");
  return Eigen::Map<const Eigen::RowVectorXd>(values.data(),
                                              Eigen::Index(values.size()))
      .cast<float>();
}

void
readClass(const YamlMap& entry, Label label, LabelCalibration& calibration)
{
  double bias = 0.0;
  entry.get("bias", bias);
  calibration.bias[label - 1] = static_cast<float>(bias);
  calibration.fitted[label - 1u] = true;
  for (ClassCurves& curves : calibration.curves) {
    const std::string name = nameOf(curves.feature);
    if (entry.has(name))
      curves.values.row(label - 1) = readValues(entry, name, curves, name + " has ");
  }
  entry.refuseUnknownKeys();
}

// Zero curves at the knots of each feature.
std::vector<ClassCurves>
readKnots(const YamlMap& knots, int classes)
{
  std::vector<ClassCurves> curves;
  for (std::size_t f = 0; f < feature_count; ++f) {
    std::vector<double> values;
    if (!knots.get(feature_names[f], values))
      continue;
    curves.push_back({Feature(f),
                      {values.begin(), values.end()},
                      Eigen::MatrixXf::Zero(classes, Eigen::Index(values.size()))});
    if (!areKnots(curves.back().knots))
      fail<BadInputException>(knots.where(feature_names[f]),
                              ": expected two or more rising knots");
  }
  knots.refuseUnknownKeys();
  return curves;
}

// Histograms; missing classes are zero.
void
readSeen(const YamlMap& file, const LabelSet& label_set, LabelCalibration& calibration)
{
  if (!file.has("seen"))
    return;
  const YamlMap seen = file.requireMap("seen");
  calibration.usual_distance =
      static_cast<float>(seen.require<double>("usual_distance"));
  for (const ClassCurves& curves : calibration.curves) {
    const YamlMap classes = seen.requireMap(nameOf(curves.feature));
    Eigen::MatrixXf fractions =
        Eigen::MatrixXf::Zero(curves.values.rows(), curves.values.cols());
    for (const std::string& name : classes.keys())
      fractions.row(labelOf(classes, name, name, label_set) - 1) =
          readValues(classes, name, curves, "");
    calibration.seen.push_back(std::move(fractions));
  }
  seen.refuseUnknownKeys();
}

} // namespace

LabelCalibration
readCalibration(const std::string& path, const LabelSet& label_set)
{
  const YamlMap file = YamlMap::load(path);
  LabelCalibration calibration = LabelCalibration::identity(label_set.size());
  calibration.fitted.assign(calibration.fitted.size(), false);
  std::string of = "pixels"; // earlier versions also calibrated cliques
  if (file.get("of", of) && of != "pixels")
    fail<BadInputException>(file.where("of"), ": is a calibration of '", of,
                            "', expected of pixels");
  calibration.sharpness = static_cast<float>(file.require<double>("sharpness"));
  if (!(calibration.sharpness >= 0.0f))
    fail<BadInputException>(file.where("sharpness"), ": sharpness is ",
                            calibration.sharpness, ", expected 0 or more");
  for (const std::string& name : file.require<std::vector<std::string>>("ground"))
    calibration.ground.push_back(labelOf(file, "ground", name, label_set));
  calibration.curves = readKnots(file.requireMap("knots"), label_set.size());
  const YamlMap classes = file.requireMap("classes");
  for (const std::string& name : classes.keys())
    readClass(classes.requireMap(name), labelOf(classes, name, name, label_set),
              calibration);
  readSeen(file, label_set, calibration);
  file.refuseUnknownKeys();
  readFrom(path, [&] { calibration.validate(); });
  return calibration;
}

} // namespace pcl_semantic
