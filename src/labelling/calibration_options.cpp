// SPDX-License-Identifier: BSD-3-Clause
#include "calibration_term.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/labelling/calibration_fit.h>

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
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "calibration: " << count << " labels for " << network.size()
                                        << " distributions and " << features.size()
                                        << " lists of features");
  if (!weights.empty() && weights.size() != count)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "calibration: " << count << " labels for " << weights.size()
                                        << " weights");
  for (const float weight : weights)
    if (!(weight > 0.0f && std::isfinite(weight)))
      PCL_THROW_EXCEPTION(InvalidParameterException, "calibration: a weight is "
                                                         << weight
                                                         << ", expected more than 0");
  for (const Label label : truth)
    if (label > network.classes())
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "calibration: truth " << int(label) << " of "
                                                << network.classes() << " classes");
}

void
CalibrationOptions::validate() const
{
  for (const auto& [name, value, most] :
       {std::tuple("balance", balance, 1.0),
        std::tuple("bias_penalty", bias_penalty, 1e6),
        std::tuple("curve_penalty", curve_penalty, 1e6)})
    if (!(value >= 0.0 && value <= most))
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          name << " is " << value << ", expected 0 to " << most);
  for (const auto& [feature, knots] : curves)
    if (!areKnots(knots))
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "knots of " << nameOf(feature)
                                      << ": expected two or more that rise");
  if (!areInOrder(curves))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "knots: a feature comes twice, or out of order");
  if (iterations < 1)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "iterations is " << iterations << ", expected 1 or more");
}

} // namespace pcl_semantic
