// SPDX-License-Identifier: BSD-3-Clause
#include "label_refiner_builder.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/crf_energy.h>
#include <pcl_semantic/crf/mean_field.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

constexpr float greatest_weight = 1e9f; // as that of the parameters

bool
isDistribution(const Eigen::Ref<const Eigen::VectorXf>& column)
{
  return column.minCoeff() >= 0.0f &&
         (std::isfinite(column.sum()) || column.allFinite());
}

// Refuses what is no distribution; counts the unlabelled ones.
std::size_t
checkMeasurements(const LabelDistributions& measured, const pcl::Indices& indices)
{
  const auto count = static_cast<Eigen::Index>(indices.size());
  Eigen::Index bad = count, unlabelled = 0;
#pragma omp parallel for schedule(static) reduction(min : bad) reduction(+ : unlabelled)
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto column = measured.matrix().col(indices[std::size_t(k)]);
    if (!isDistribution(column))
      bad = std::min(bad, k);
    unlabelled += column.isZero(0.0f);
  }
  if (bad < count)
    PCL_THROW_EXCEPTION(BadInputException, "the label distribution of point "
                                               << indices[std::size_t(bad)]
                                               << " has a negative or "
                                                  "non-finite probability");
  return std::size_t(unlabelled);
}

void
normalize(const pcl::Indices& indices, LabelDistributions& distributions)
{
#pragma omp parallel for schedule(static)
  for (std::size_t k = 0; k < indices.size(); ++k) {
    auto column = distributions.matrix().col(indices[k]);
    const double sum = column.cast<double>().sum();
    if (sum > 0.0)
      column = (column.cast<double>() / sum).cast<float>();
  }
}

// The marginals for the measurements. An element that is unlabelled and hears of no
// label either has a uniform one, of which the first class would be the largest: it
// stays unlabelled.
void
writeResult(const MeanField::Marginals& marginals, const pcl::Indices& indices,
            LabelDistributions& distributions)
{
#pragma omp parallel for schedule(static)
  for (Eigen::Index k = 0; k < marginals.cols(); ++k) {
    auto column = distributions.matrix().col(indices[std::size_t(k)]);
    const auto marginal = marginals.col(k);
    if (!column.isZero(0.0f) || marginal.minCoeff() < marginal.maxCoeff())
      column = marginal;
  }
}

// The row of the largest value of every column.
std::vector<int>
largestRows(const MeanField::Marginals& values)
{
  std::vector<int> rows(static_cast<std::size_t>(values.cols()));
  for (Eigen::Index i = 0; i < values.cols(); ++i) {
    Eigen::Index row = 0;
    values.col(i).maxCoeff(&row);
    rows[std::size_t(i)] = int(row);
  }
  return rows;
}

double
energyOfMap(const CrfModel& model, const MeanField& inference)
{
  const std::vector<int> labels = largestRows(inference.marginals());
  if (model.cliques.empty() || model.cliques[0].type == CliquePotential::Type::pn_potts)
    return energy(model, labels, {});
  return energy(model, labels, largestRows(inference.cliqueMarginals()));
}

} // namespace

void
LabelRefiner::setParameters(const SemanticCRFParameters& parameters)
{
  parameters.validate();
  parameters_ = parameters;
}

void
LabelRefiner::setCompatibility(const Eigen::MatrixXf& costs)
{
  compatibility_ = costs.size() > 0 ? LabelCompatibility(costs) : LabelCompatibility();
}

void
LabelRefiner::addKernel(const Eigen::MatrixXf& features, float weight)
{
  if (!(weight >= 0.0f && weight <= greatest_weight))
    PCL_THROW_EXCEPTION(InvalidParameterException, "kernel weight is "
                                                       << weight << ", expected 0 to "
                                                       << greatest_weight);
  if (features.rows() < 1 || !features.allFinite())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "the features of a kernel are "
                            << (features.rows() < 1 ? "missing" : "not all finite"));
  kernels_.push_back({weight, 1.0f, features});
}

void
LabelRefiner::clearKernels()
{
  kernels_.clear();
}

void
LabelRefiner::setCliques(const std::vector<pcl::PointIndices>& cliques)
{
  for (std::size_t c = 0; c < cliques.size(); ++c)
    if (cliques[c].indices.empty())
      PCL_THROW_EXCEPTION(InvalidParameterException, "clique " << c << " is empty");
  cliques_ = cliques;
  has_cliques_ = true;
}

void
LabelRefiner::setCliqueWeights(const Eigen::MatrixXf& weights)
{
  for (Eigen::Index c = 0; c < weights.cols(); ++c)
    for (Eigen::Index l = 0; l < weights.rows(); ++l)
      if (!(weights(l, c) >= 0.0f && weights(l, c) <= greatest_weight))
        PCL_THROW_EXCEPTION(InvalidParameterException,
                            "the weight of clique " << c << " is " << weights(l, c)
                                                    << ", expected 0 to "
                                                    << greatest_weight);
  clique_weights_ = weights;
}

void
LabelRefiner::setCliqueCosts(const Eigen::MatrixXf& costs)
{
  if (!costs.allFinite())
    PCL_THROW_EXCEPTION(InvalidParameterException, "a clique cost is not finite");
  clique_costs_ = costs;
}

void
LabelRefiner::setInitialDistributions(const LabelDistributions& distributions)
{
  for (Eigen::Index i = 0; i < distributions.size(); ++i)
    if (!isDistribution(distributions.matrix().col(i)))
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "the initial distribution of point "
                              << i << " has a negative or non-finite probability");
  initial_ = distributions;
}

void
LabelRefiner::setComputeEnergies(bool compute)
{
  compute_energies_ = compute;
}

void
LabelRefiner::refine(Elements& elements, LabelDistributions& distributions)
{
  report_ = CRFReport();
  report_.unlabelled = checkMeasurements(distributions, elements.indices);
  if (compute_energies_ && !compatibility_.isSymmetric())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "energies need a symmetric label compatibility");
  if (elements.indices.empty())
    return;
  if (model_ == CRFModelType::unary)
    return normalize(elements.indices, distributions);
  Builder builder(*this, elements, distributions);
  CrfModel model = builder.build();
  const Eigen::MatrixXf initial = builder.initial();
  CrfModel kept;
  if (compute_energies_)
    kept = model;
  MeanField inference(std::move(model), initial.size() > 0 ? &initial : nullptr);
  report_.updates = inference.run(parameters_.iterations, parameters_.settled);
  report_.last_change = inference.lastChange();
  if (compute_energies_) {
    report_.free_energy = inference.freeEnergy();
    report_.energy = energyOfMap(kept, inference);
  }
  writeResult(inference.marginals(), elements.indices, distributions);
}

} // namespace pcl_semantic
