// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/filters/crf_settings.h>

#include "core/fail.h"

namespace pcl_semantic {

namespace {

constexpr float greatest_weight = 1e9f; // as for the weights among the parameters

} // namespace

void
CRFSettings::setParameters(const SemanticCRFParameters& parameters)
{
  parameters.validate();
  terms_.parameters = parameters;
}

void
CRFSettings::setCompatibility(const Eigen::MatrixXf& costs)
{
  terms_.compatibility =
      costs.size() > 0 ? LabelCompatibility(costs) : LabelCompatibility();
}

void
CRFSettings::addKernel(const Eigen::MatrixXf& features, float weight)
{
  if (!(weight >= 0.0f && weight <= greatest_weight))
    badParameter("kernel weight is ", weight, ", expected 0 to ", greatest_weight);
  if (features.rows() < 1 || !features.allFinite())
    badParameter("the features of a kernel are ",
                 (features.rows() < 1 ? "missing" : "not all finite"));
  terms_.kernels.push_back({weight, 1.0f, features});
}

void
CRFSettings::setClassFrequencies(const Eigen::VectorXd& frequencies)
{
  if (!(frequencies.array() >= 0.0).all() || !frequencies.allFinite())
    badParameter("a class frequency is negative or not finite");
  terms_.class_frequencies = frequencies;
}

} // namespace pcl_semantic
