/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "label_refiner_builder.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/crf_energy.h>
#include <pcl_semantic/crf/mean_field.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

// Refuses what is no distribution; counts the unlabelled ones.
std::size_t
checkMeasurements(const LabelDistributions& measured, const pcl::Indices& indices)
{
  Eigen::Index bad = measured.size(), unlabelled = 0;
#pragma omp parallel for schedule(static) reduction(min : bad) reduction(+ : unlabelled)
  for (Eigen::Index i = 0; i < measured.size(); ++i) {
    const auto column = measured.matrix().col(i);
    if (!column.allFinite() || column.minCoeff() < 0.0f)
      bad = std::min(bad, i);
    unlabelled += column.isZero(0.0f);
  }
  if (bad < measured.size())
    PCL_THROW_EXCEPTION(BadInputException, "the label distribution of point "
                                               << indices[std::size_t(bad)]
                                               << " has a negative or "
                                                  "non-finite probability");
  return std::size_t(unlabelled);
}

// An element that is unlabelled and hears of no label either has a uniform marginal, of
// which the first class would be the largest: it stays unlabelled.
void
clearUninformed(const LabelDistributions& measured, Eigen::MatrixXf& marginals)
{
#pragma omp parallel for schedule(static)
  for (Eigen::Index i = 0; i < measured.size(); ++i)
    if (measured.matrix().col(i).isZero(0.0f) &&
        marginals.col(i).minCoeff() == marginals.col(i).maxCoeff())
      marginals.col(i).setZero();
}

// The row of the largest value of every column.
std::vector<int>
largestRows(const Eigen::MatrixXf& values)
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
  history_.reset();
}

void
LabelRefiner::setCompatibility(const Eigen::MatrixXf& costs)
{
  compatibility_ = costs.size() > 0 ? LabelCompatibility(costs) : LabelCompatibility();
  history_.reset();
}

void
LabelRefiner::addKernel(const Eigen::MatrixXf& features, float weight)
{
  if (!(weight >= 0.0f) || !std::isfinite(weight))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "kernel weight is " << weight << ", expected 0 or more");
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
  if (weights.size() > 0 && (!weights.allFinite() || weights.minCoeff() < 0.0f))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "a clique weight is negative or not finite");
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
  initial_ = distributions;
}

void
LabelRefiner::setComputeEnergies(bool compute)
{
  compute_energies_ = compute;
}

void
LabelRefiner::setIncremental(bool incremental)
{
  incremental_ = incremental;
  history_.reset();
}

LabelDistributions
LabelRefiner::refine(Elements& elements)
{
  report_ = CRFReport();
  report_.unlabelled = checkMeasurements(elements.measured, elements.indices);
  if (compute_energies_ && !compatibility_.isSymmetric())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "energies need a symmetric label compatibility");
  if (model_ == CRFModelType::unary || elements.indices.empty())
    return elements.measured;
  Builder builder(*this, elements);
  if (builder.isIncremental()) {
    history_ = DenseHistory::update(builder.denseProblem(), history_.get());
    report_.updates = 1;
    report_.last_change = history_->lastChange();
    LabelDistributions refined;
    refined.matrix() = history_->marginals();
    clearUninformed(elements.measured, refined.matrix());
    return refined;
  }
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
  LabelDistributions refined;
  refined.matrix() = inference.marginals();
  clearUninformed(elements.measured, refined.matrix());
  return refined;
}

} // namespace pcl_semantic
