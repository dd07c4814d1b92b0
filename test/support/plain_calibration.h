/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/labelling/label_calibration.h>

#include <cmath>
#include <limits>
#include <random>

namespace pcl_semantic {

/** \brief A curve of class \a l at a value; 0 where it is not known. */
inline double
plainCurve(const ClassCurves& curves, int l, double value)
{
  const std::vector<float>& knots = curves.knots;
  if (knots.empty() || std::isnan(value))
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

/** \brief exp of a class's score, as the formula of LabelCalibration has it. */
inline double
plainWeight(const LabelCalibration& calibration, int l, double probability,
            const PointGeometry& place)
{
  return std::pow(std::max(probability, 1e-4), double(calibration.sharpness)) *
         std::exp(calibration.bias[l] +
                  plainCurve(calibration.height, l, place.height) +
                  plainCurve(calibration.distance, l, place.distance) +
                  plainCurve(calibration.level, l, place.level));
}

/** \brief calibrate() point by point and class by class, in double. */
inline Eigen::MatrixXd
plainCalibrate(const LabelCalibration& calibration, const LabelDistributions& network,
               const std::vector<PointGeometry>& geometry)
{
  Eigen::MatrixXd result = network.matrix().cast<double>();
  for (Eigen::Index i = 0; i < result.cols(); ++i) {
    double mass = 0.0, total = 0.0;
    for (int l = 0; l < calibration.classes(); ++l)
      if (calibration.fitted[std::size_t(l)]) {
        mass += result(l, i);
        total += plainWeight(calibration, l, result(l, i), geometry[std::size_t(i)]);
      }
    if (mass == 0.0)
      continue;
    for (int l = 0; l < calibration.classes(); ++l)
      if (calibration.fitted[std::size_t(l)])
        result(l, i) =
            mass / total *
            plainWeight(calibration, l, result(l, i), geometry[std::size_t(i)]);
  }
  return result;
}

/** \brief Distributions between even and sure, with probabilities down to 1e-9. */
inline LabelDistributions
randomNetwork(int classes, Eigen::Index count, unsigned seed)
{
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0.0f, 3.0f);
  return LabelDistributions(Eigen::MatrixXf::NullaryExpr(classes, count, [&] {
                              return std::exp(normal(random));
                            }).eval());
}

/** \brief Places within and beyond the knots; of one in ten each is not known. */
inline std::vector<PointGeometry>
randomPlaces(std::size_t count, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> height(-1.0f, 4.0f), distance(1.0f, 50.0f),
      level(0.0f, 1.0f), chance(0.0f, 1.0f);
  std::vector<PointGeometry> places(count);
  for (PointGeometry& place : places) {
    place = {height(random), distance(random), level(random)};
    for (float* const value : {&place.height, &place.distance, &place.level})
      if (chance(random) < 0.1f)
        *value = std::numeric_limits<float>::quiet_NaN();
  }
  return places;
}

/** \brief One with all curves, of three or four knots. */
inline LabelCalibration
randomCalibration(int classes, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(-1.0f, 1.0f);
  const auto any = [&] { return value(random); };
  LabelCalibration calibration = LabelCalibration::identity(classes);
  calibration.sharpness = 0.7f;
  calibration.bias = Eigen::VectorXf::NullaryExpr(classes, any);
  calibration.height.knots = {-0.5f, 0.1f, 0.8f, 3.0f};
  calibration.distance.knots = {5.0f, 15.0f, 40.0f};
  calibration.level.knots = {0.0f, 0.6f, 1.0f};
  for (ClassCurves* const curves :
       {&calibration.height, &calibration.distance, &calibration.level})
    curves->values =
        Eigen::MatrixXf::NullaryExpr(classes, Eigen::Index(curves->knots.size()), any);
  return calibration;
}

} // namespace pcl_semantic
