/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/mean_field.h>
#include <pcl_semantic/crf/truncated_kernel.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <cmath>

namespace pcl_semantic {

namespace {

// Costs -log p, eq. (4); an unlabelled point has no preference.
Eigen::MatrixXf
unaryCosts(const LabelDistributions& measured)
{
  constexpr float smallest = 1e-6f;
  Eigen::MatrixXf costs(measured.classes(), measured.size());
  for (Eigen::Index i = 0; i < measured.size(); ++i) {
    if (measured.mapLabel(i) == kUnlabelled)
      costs.col(i).setZero();
    else
      costs.col(i) = -measured.matrix().col(i).array().max(smallest).log();
  }
  return costs;
}

// A point that is unlabelled and hears of no label either has a uniform marginal, of
// which the first class would be the largest: it stays unlabelled.
void
clearUninformed(const LabelDistributions& measured, LabelDistributions& refined)
{
  for (Eigen::Index i = 0; i < measured.size(); ++i) {
    auto marginal = refined.matrix().col(i);
    if (measured.mapLabel(i) == kUnlabelled &&
        marginal.minCoeff() == marginal.maxCoeff())
      marginal.setZero();
  }
}

void
require(bool holds, const char* name, double value, const char* expected)
{
  if (!holds || !std::isfinite(value))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        name << " is " << value << ", expected " << expected);
}

} // namespace

void
SemanticCRFParameters::validate() const
{
  const char* const positive = "more than 0";
  const char* const not_negative = "0 or more";
  require(smoothness_weight >= 0, "smoothness_weight", smoothness_weight, not_negative);
  require(appearance_weight >= 0, "appearance_weight", appearance_weight, not_negative);
  require(smoothness_deviation > 0, "smoothness_deviation", smoothness_deviation,
          positive);
  require(appearance_deviation > 0, "appearance_deviation", appearance_deviation,
          positive);
  require(colour_deviation > 0, "colour_deviation", colour_deviation, positive);
  require(radius > 0, "radius", radius, positive);
  require(iterations >= 0, "iterations", iterations, not_negative);
}

LabelDistributions
refineLabels(const Eigen::Matrix3Xf& positions, const Eigen::MatrixXf& colours,
             const LabelDistributions& measured,
             const SemanticCRFParameters& parameters)
{
  std::vector<GaussianTerm> terms;
  terms.push_back({float(parameters.smoothness_weight),
                   float(parameters.smoothness_deviation), Eigen::MatrixXf()});
  if (colours.size() > 0)
    terms.push_back({float(parameters.appearance_weight),
                     float(parameters.appearance_deviation),
                     colours / float(parameters.colour_deviation)});
  CrfModel model;
  model.unary = unaryCosts(measured);
  model.kernels.push_back(
      std::make_shared<TruncatedKernel>(positions, terms, float(parameters.radius)));
  MeanField inference(std::move(model));
  for (int i = 0; i < parameters.iterations; ++i)
    inference.update();
  LabelDistributions refined(inference.marginals());
  clearUninformed(measured, refined);
  return refined;
}

template class SemanticCRF<pcl::PointXYZL>;
template class SemanticCRF<pcl::PointXYZRGBL>;

} // namespace pcl_semantic
