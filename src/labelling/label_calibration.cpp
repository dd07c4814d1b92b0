// SPDX-License-Identifier: BSD-3-Clause
#include "calibration_term.h"

#include <pcl_semantic/core/exceptions.h>

#include <pcl_semantic/core/parallel_guard.h>

namespace pcl_semantic {

namespace {

// Of values in logarithms: sums of them, times a logarithm, are finite.
constexpr float largest_value = 1e6f;

bool
areSmall(const Eigen::Ref<const Eigen::MatrixXf>& values)
{
  return (values.array().abs() <= largest_value).all(); // false for NaN
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
      const CurvePlace place = placeOn(curves.knots, features[curves.feature]);
      if (place.first >= 0)
        logs_ += (1.0f - place.share) * curves.values.col(place.first) +
                 place.share * curves.values.col(place.first + 1);
    }
    shareOut(sum - kept, distribution);
  }

private:
  void
  shareOut(float mass, float* distribution)
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
      !(sharpness >= 0.0f && sharpness <= largest_value))
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

} // namespace pcl_semantic
