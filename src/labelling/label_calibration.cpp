// SPDX-License-Identifier: BSD-3-Clause
#include "calibration_term.h"
#include "core/parallel_guard.h"
#include "files/yaml_config.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/labelling/label_calibration.h>

#include <limits>
#include <sstream>

namespace pcl_semantic {

namespace {

// Of values in logarithms: sums of them, times a logarithm, are finite.
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
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "calibration: the curves of "
                            << nameOf(curves.feature)
                            << " need two or more rising knots and " << classes
                            << " values at each, -1e6 to 1e6");
}

// Works on one column after the other, with room for L values.
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
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "calibration: expected a bias for each of "
                            << classes()
                            << " classes, -1e6 to 1e6, and a sharpness of 0 to 1e6");
  for (const Label label : ground)
    if (label < 1 || label > classes())
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "calibration: ground label " << int(label) << " is not 1 to "
                                                       << classes());
  for (const ClassCurves& each : curves)
    requireCurves(each, classes());
  if (!areInOrder(curves))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "calibration: a feature has two curves, or comes out of order");
}

LabelDistributions
calibrate(const LabelCalibration& calibration, const LabelDistributions& distributions,
          const std::vector<PointFeatures>& features)
{
  calibration.validate();
  if (distributions.classes() != calibration.classes() ||
      (!features.empty() && Eigen::Index(features.size()) != distributions.size()))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "calibration of " << calibration.classes() << " classes: got "
                                          << distributions.classes() << " classes of "
                                          << distributions.size()
                                          << " points, features of "
                                          << features.size());
  LabelDistributions result = distributions;
#pragma omp parallel
  {
    Calibrator calibrator(calibration);
#pragma omp for
    for (Eigen::Index i = 0; i < result.size(); ++i)
      calibrator.apply(features.empty() ? PointFeatures{} : features[std::size_t(i)],
                       result.column(i));
  }
  return result;
}

namespace {

Label
labelOf(const YamlMap& map, const std::string& key, const std::string& name,
        const LabelSet& label_set)
{
  const Label label = label_set.find(name);
  if (label == kUnlabelled)
    PCL_THROW_EXCEPTION(BadInputException, map.where(key)
                                               << ": class '" << name
                                               << "' is not in the label set");
  return label;
}

void
readClass(const YamlMap& entry, Label label, LabelCalibration& calibration)
{
  double bias = 0.0;
  entry.get("bias", bias);
  calibration.bias[label - 1] = static_cast<float>(bias);
  calibration.fitted[label - 1u] = true;
  for (ClassCurves& curves : calibration.curves) {
    const char* const name = nameOf(curves.feature);
    std::vector<double> values;
    if (!entry.get(name, values))
      continue;
    if (values.size() != curves.knots.size())
      PCL_THROW_EXCEPTION(BadInputException, entry.where(name)
                                                 << ": " << name << " has "
                                                 << values.size() << " values for "
                                                 << curves.knots.size() << " knots");
    for (std::size_t i = 0; i < values.size(); ++i)
      curves.values(label - 1, Eigen::Index(i)) = static_cast<float>(values[i]);
  }
  entry.refuseUnknownKeys();
}

// Curves of zero at the knots of each feature.
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
      PCL_THROW_EXCEPTION(BadInputException, knots.where(feature_names[f])
                                                 << ": expected two or more rising "
                                                    "knots");
  }
  knots.refuseUnknownKeys();
  return curves;
}

std::string
listOf(const float* values, std::size_t count, std::ptrdiff_t stride)
{
  std::ostringstream text;
  text.precision(std::numeric_limits<float>::max_digits10);
  for (std::size_t i = 0; i < count; ++i)
    text << (i ? ", " : "[") << values[std::ptrdiff_t(i) * stride];
  text << "]";
  return text.str();
}

} // namespace

LabelCalibration
readCalibration(const std::string& path, const LabelSet& label_set,
                const std::string& of)
{
  const YamlMap file = YamlMap::load(path);
  LabelCalibration calibration = LabelCalibration::identity(label_set.size());
  calibration.fitted.assign(calibration.fitted.size(), false);
  if (file.get("of", calibration.of) && calibration.of != of)
    PCL_THROW_EXCEPTION(BadInputException, file.where("of") << ": is a calibration of '"
                                                            << calibration.of
                                                            << "', expected of " << of);
  calibration.sharpness = static_cast<float>(file.require<double>("sharpness"));
  if (!(calibration.sharpness >= 0.0f))
    PCL_THROW_EXCEPTION(BadInputException, file.where("sharpness")
                                               << ": sharpness is "
                                               << calibration.sharpness
                                               << ", expected 0 or more");
  for (const std::string& name : file.require<std::vector<std::string>>("ground"))
    calibration.ground.push_back(labelOf(file, "ground", name, label_set));
  calibration.curves = readKnots(file.requireMap("knots"), label_set.size());
  const YamlMap classes = file.requireMap("classes");
  for (const std::string& name : classes.keys())
    readClass(classes.requireMap(name), labelOf(classes, name, name, label_set),
              calibration);
  file.refuseUnknownKeys();
  try {
    calibration.validate();
  }
  catch (const InvalidParameterException& error) {
    PCL_THROW_EXCEPTION(BadInputException, path << ": " << error.what());
  }
  return calibration;
}

std::string
printCalibration(const LabelCalibration& calibration, const LabelSet& label_set)
{
  std::ostringstream text;
  text.precision(std::numeric_limits<float>::max_digits10);
  if (!calibration.of.empty())
    text << "of: " << calibration.of << "\n";
  text << "sharpness: " << calibration.sharpness << "\nground: [";
  for (std::size_t i = 0; i < calibration.ground.size(); ++i)
    text << (i ? ", " : "") << label_set[calibration.ground[i]].name;
  text << "]\nknots:" << (calibration.curves.empty() ? " {}\n" : "\n");
  for (const ClassCurves& curves : calibration.curves)
    text << "  " << nameOf(curves.feature) << ": "
         << listOf(curves.knots.data(), curves.knots.size(), 1) << "\n";
  text << "classes:\n";
  for (int l = 0; l < calibration.classes(); ++l) {
    if (!calibration.fitted[std::size_t(l)])
      continue;
    text << "  " << label_set[Label(l + 1)].name
         << ":\n    bias: " << calibration.bias[l] << "\n";
    for (const ClassCurves& curves : calibration.curves)
      text << "    " << nameOf(curves.feature) << ": "
           << listOf(curves.values.data() + l, curves.knots.size(),
                     calibration.classes())
           << "\n";
  }
  return text.str();
}

} // namespace pcl_semantic
