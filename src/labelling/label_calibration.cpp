/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "calibration_term.h"

#include <pcl_semantic/core/exceptions.h>

#include <pcl_semantic/core/parallel_guard.h>

namespace pcl_semantic {

namespace {

void
requireCurves(const ClassCurves& curves, int classes, const char* name)
{
  const auto& knots = curves.knots;
  const bool fits =
      knots.empty() ||
      (curves.values.rows() == classes &&
       curves.values.cols() == Eigen::Index(knots.size()) && curves.values.allFinite());
  if (!fits || !areKnots(knots))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "calibration: the curves of "
                            << name << " need two or more rising knots and " << classes
                            << " finite values at each");
}

// Works on one column after the other, with room for L values.
class Calibrator {
public:
  explicit Calibrator(const LabelCalibration& calibration)
      : calibration_(calibration), logs_(calibration.classes())
  {}

  void
  apply(const PointGeometry& geometry, float* distribution)
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
    for (const auto& [curves, value] : curvesAt(calibration_, geometry)) {
      const CurvePlace place = placeOn(curves->knots, value);
      if (place.first >= 0)
        logs_ += (1.0f - place.share) * curves->values.col(place.first) +
                 place.share * curves->values.col(place.first + 1);
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
  if (bias.size() != classes() || !bias.allFinite() || !std::isfinite(sharpness) ||
      sharpness < 0.0f)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "calibration: expected a finite bias for each of "
                            << classes() << " classes and a sharpness of 0 or more");
  for (const Label label : ground)
    if (label < 1 || label > classes())
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "calibration: ground label " << int(label) << " is not 1 to "
                                                       << classes());
  requireCurves(height, classes(), "height");
  requireCurves(distance, classes(), "distance");
  requireCurves(level, classes(), "level");
}

LabelDistributions
calibrate(const LabelCalibration& calibration, const LabelDistributions& distributions,
          const std::vector<PointGeometry>& geometry)
{
  calibration.validate();
  if (distributions.classes() != calibration.classes() ||
      (!geometry.empty() && Eigen::Index(geometry.size()) != distributions.size()))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "calibration of " << calibration.classes() << " classes: got "
                                          << distributions.classes() << " classes of "
                                          << distributions.size()
                                          << " points, geometry of "
                                          << geometry.size());
  LabelDistributions result = distributions;
#pragma omp parallel
  {
    Calibrator calibrator(calibration);
#pragma omp for
    for (Eigen::Index i = 0; i < result.size(); ++i)
      calibrator.apply(geometry.empty() ? PointGeometry{} : geometry[std::size_t(i)],
                       result.column(i));
  }
  return result;
}

} // namespace pcl_semantic
