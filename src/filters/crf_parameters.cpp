// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/filters/crf_parameters.h>

#include "core/fail.h"

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

void
require(bool holds, const char* name, double value, const char* expected)
{
  if (!holds || !std::isfinite(value))
    badParameter(name, " is ", value, ", expected ", expected);
}

void
requireWeight(const char* name, double value)
{
  require(value >= 0.0 && value <= 1e9, name, value, "0 to 1e9");
}

void
requireDeviation(const char* name, double value)
{
  require(value >= 1e-9 && value <= 1e9, name, value, "more than 0, 1e-9 to 1e9");
}

void
requireDeviationOrZero(const char* name, double value)
{
  require(value == 0.0 || (value >= 1e-9 && value <= 1e9), name, value,
          "0 (automatic) or 1e-9 to 1e9");
}

double
least(double value, double limit)
{
  return limit > 0.0 ? std::min(value, limit) : value;
}

} // namespace

void
SemanticCRFParameters::validate() const
{
  requireWeight("smoothness_weight", smoothness_weight);
  requireDeviationOrZero("smoothness_deviation", smoothness_deviation);
  requireWeight("appearance_weight", appearance_weight);
  requireDeviationOrZero("appearance_deviation", appearance_deviation);
  requireDeviationOrZero("colour_deviation", colour_deviation);
  require(radius > 0.0 && radius <= 100.0, "radius", radius,
          "more than 0, at most 100");
  require(iterations >= 0, "iterations", iterations, "0 or more");
  require(temperature >= 0.01 && temperature <= 1000.0, "temperature", temperature,
          "0.01 to 1000");
  require(logit_adjustment == -1.0 ||
              (logit_adjustment >= 0.0 && logit_adjustment <= 10.0),
          "crf_logit_adjustment", logit_adjustment, "-1 or 0 to 10");
  requireWeight("clique_weight", clique_weight);
  require(clique_truncation > 0.0 && clique_truncation <= 1.0, "clique_truncation",
          clique_truncation, "more than 0, at most 1");
  requireWeight("clique_appearance_weight", clique_appearance_weight);
  requireDeviation("clique_appearance_deviation", clique_appearance_deviation);
  requireDeviation("clique_colour_deviation", clique_colour_deviation);
}

SemanticCRFParameters
SemanticCRFParameters::resolved(double spacing, bool has_colours, double extent) const
{
  SemanticCRFParameters values = *this;
  if (values.logit_adjustment < 0.0) // colours may be of a scan
    values.logit_adjustment = values.sensor == PointSensor::rgbd ? 1.0 : 0.0;
  if (values.sensor == PointSensor::automatic)
    values.sensor = has_colours ? PointSensor::rgbd : PointSensor::lidar;
  const bool is_rgbd = values.sensor == PointSensor::rgbd;
  double smoothness = 0.2, appearance = 0.2; // [m]
  if (is_rgbd) {
    smoothness = std::max(least(0.1, extent / 8.0), spacing);
    appearance = std::max(least(0.2, extent / 4.0), 2.0 * spacing);
  }
  else if (spacing > 0.0)
    smoothness = appearance = std::clamp(0.2, 2.0 * spacing, 10.0 * spacing);
  const auto setIfAutomatic = [](auto& value, auto automatic) {
    if (value == 0)
      value = automatic;
  };
  setIfAutomatic(values.iterations, values.sensor == PointSensor::stereo ? 1 : 3);
  setIfAutomatic(values.smoothness_deviation, smoothness);
  setIfAutomatic(values.appearance_deviation, appearance);
  setIfAutomatic(values.colour_deviation, is_rgbd ? 30.0 : 8.0);
  return values;
}

SemanticCRFParameters
SemanticCRFParameters::forMaps()
{
  SemanticCRFParameters parameters;
  parameters.temperature = 3.0;
  parameters.logit_adjustment = -1.0;
  return parameters;
}

SemanticCRFParameters
SemanticCRFParameters::forImages()
{
  SemanticCRFParameters parameters;
  parameters.smoothness_deviation = 3.0;
  parameters.appearance_deviation = 40.0;
  parameters.colour_deviation = 4.0;
  parameters.iterations = 5;
  parameters.keep_thin = false;
  parameters.clique_weight = 1.0;
  parameters.clique_truncation = 0.3;
  parameters.clique_appearance_deviation = 40.0;
  return parameters;
}

} // namespace pcl_semantic
