// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/labelling/label_calibration.h>

#include <cmath>
#include <limits>
#include <random>

namespace pcl_semantic {

/** \brief Value of class \a l's curve; 0 where unknown. */
inline double
plainCurve(const ClassCurves& curves, int l, double value)
{
  const std::vector<float>& knots = curves.knots;
  if (std::isnan(value))
    return 0.0;
  if (value <= knots.front())
    return curves.values(l, 0);
  for (std::size_t k = 1; k < knots.size(); ++k)
    if (value <= knots[k]) {
      const double share = (value - knots[k - 1]) / (double(knots[k]) - knots[k - 1]);
      return (1.0 - share) * curves.values(l, Eigen::Index(k) - 1) +
             share * curves.values(l, Eigen::Index(k));
    }
  return curves.values(l, Eigen::Index(knots.size()) - 1);
}

/** \brief exp of a class's score, as in the formula of LabelCalibration. */
inline double
plainWeight(const LabelCalibration& calibration, int l, double probability,
            const PointFeatures& features)
{
  double score = calibration.bias[l];
  for (const ClassCurves& curves : calibration.curves)
    score += plainCurve(curves, l, features[curves.feature]);
  return std::pow(std::max(probability, 1e-4), double(calibration.sharpness)) *
         std::exp(score);
}

/** \brief Reference for calibrate(): point by point and class by class, in double
 * precision. */
inline Eigen::MatrixXd
plainCalibrate(const LabelCalibration& calibration, const LabelDistributions& network,
               const std::vector<PointFeatures>& features)
{
  Eigen::MatrixXd result = network.matrix().cast<double>();
  for (Eigen::Index i = 0; i < result.cols(); ++i) {
    double mass = 0.0, total = 0.0;
    for (int l = 0; l < calibration.classes(); ++l)
      if (calibration.fitted[std::size_t(l)]) {
        mass += result(l, i);
        total += plainWeight(calibration, l, result(l, i), features[std::size_t(i)]);
      }
    if (mass == 0.0)
      continue;
    for (int l = 0; l < calibration.classes(); ++l)
      if (calibration.fitted[std::size_t(l)])
        result(l, i) =
            mass / total *
            plainWeight(calibration, l, result(l, i), features[std::size_t(i)]);
  }
  return result;
}

/** \brief Distributions from uniform to certain, with probabilities down to 1e-9. */
inline LabelDistributions
randomNetwork(int classes, Eigen::Index count, unsigned seed)
{
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0.0f, 3.0f);
  return LabelDistributions(Eigen::MatrixXf::NullaryExpr(classes, count, [&] {
                              return std::exp(normal(random));
                            }).eval());
}

/** \brief Features within and beyond the knots of randomCalibration(); one in ten of
 * each is unknown. */
inline std::vector<PointFeatures>
randomFeatures(std::size_t count, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> chance(0.0f, 1.0f);
  const std::array<std::pair<float, float>, feature_count> ranges{{{-1.0f, 5.5f},
                                                                   {2.0f, 44.0f},
                                                                   {-0.1f, 1.1f},
                                                                   {-2.0f, 22.0f},
                                                                   {0.0f, 1.0f},
                                                                   {0.2f, 0.5f},
                                                                   {0.2f, 0.5f}}};
  std::vector<PointFeatures> points(count);
  for (PointFeatures& features : points)
    for (std::size_t f = 0; f < feature_count; ++f) {
      std::uniform_real_distribution<float> value(ranges[f].first, ranges[f].second);
      if (chance(random) > 0.1f)
        features[Feature(f)] = value(random);
    }
  return points;
}

/** \brief Features of a point, the others unknown. */
inline PointFeatures
featuresAt(float height, float distance, float level)
{
  PointFeatures features;
  features[Feature::height] = height;
  features[Feature::distance] = distance;
  features[Feature::level] = level;
  return features;
}

/** \brief A calibration with curves over height, distance, level, side and red, with
 * three or four knots each. */
inline LabelCalibration
randomCalibration(int classes, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(-1.0f, 1.0f);
  const auto any = [&] { return value(random); };
  LabelCalibration calibration = LabelCalibration::identity(classes);
  calibration.sharpness = 0.7f;
  calibration.bias = Eigen::VectorXf::NullaryExpr(classes, any);
  calibration.curves = {{Feature::height, {-0.5f, 0.1f, 0.8f, 3.0f}, {}},
                        {Feature::distance, {5.0f, 15.0f, 40.0f}, {}},
                        {Feature::level, {0.0f, 0.6f, 1.0f}, {}},
                        {Feature::side, {0.0f, 4.0f, 12.0f}, {}},
                        {Feature::red, {0.3f, 0.34f, 0.4f}, {}}};
  for (ClassCurves& curves : calibration.curves)
    curves.values =
        Eigen::MatrixXf::NullaryExpr(classes, Eigen::Index(curves.knots.size()), any);
  return calibration;
}

} // namespace pcl_semantic
