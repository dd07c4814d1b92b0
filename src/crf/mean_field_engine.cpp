/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "mean_field_engine.h"

#include "kernels/soft_max.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/matrix_kernel.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

constexpr Eigen::Index block_size = 64; // variables that stay in the fast cache

void
requireMatrices(const std::vector<std::shared_ptr<const PairwiseKernel>>& kernels)
{
  for (const auto& kernel : kernels) {
    const auto* const matrix = dynamic_cast<const MatrixKernel*>(kernel.get());
    if (!matrix || !matrix->isSymmetric())
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "sequential updates need a symmetric matrix for every kernel "
                          "(MatrixKernel)");
  }
}

} // namespace

MeanField::Engine::Engine(CrfModel&& model, const Eigen::MatrixXf* initial)
    : model_(std::move(model))
{
  const Eigen::MatrixXf unary = std::move(model_.unary);
  model_.unary.resize(0, 0);
  setCosts(unary);
  marginals_ = PaddedColumns(unary.rows(), unary.cols());
  messages_ = PaddedColumns(unary.rows(), unary.cols());
  softMax(costs_.column(0), messages_.column(0), marginals_.column(0),
          std::size_t(unary.cols()), std::size_t(costs_.stride()));
  if (initial)
    start(*initial);
  if (!model_.compatibility.isPotts()) {
    compatibility_ = PaddedColumns(unary.rows(), unary.rows());
    for (Eigen::Index k = 0; k < unary.rows(); ++k)
      for (Eigen::Index l = 0; l < unary.rows(); ++l)
        compatibility_.column(k)[l] = model_.compatibility.cost(l, k);
  }
  if (model_.self_interaction) {
    self_responses_.assign(std::size_t(unary.cols()), 0.0f);
    for (const auto& kernel : model_.kernels)
      for (Eigen::Index i = 0; i < unary.cols(); ++i)
        self_responses_[std::size_t(i)] += kernel->diagonal(i);
  }
  for (const CliquePotential& potential : model_.cliques)
    terms_.push_back(makeCliqueTerm(potential, model_.self_interaction, costs_));
}

void
MeanField::Engine::setCosts(const Eigen::MatrixXf& unary)
{
  costs_ = PaddedColumns(unary.rows(), unary.cols(), kPaddingCost);
  for (Eigen::Index i = 0; i < unary.cols(); ++i) {
    const float least = unary.col(i).minCoeff();
    offset_ += double(least);
    for (Eigen::Index l = 0; l < unary.rows(); ++l)
      costs_.column(i)[l] = std::min(unary(l, i) - least, kPaddingCost);
  }
}

void
MeanField::Engine::start(const Eigen::MatrixXf& initial)
{
  if (initial.rows() != marginals_.rows() || initial.cols() != marginals_.columns())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "marginals to start from are "
                            << initial.rows() << " x " << initial.cols()
                            << ", expected " << marginals_.rows() << " x "
                            << marginals_.columns());
  for (Eigen::Index i = 0; i < initial.cols(); ++i) {
    const double sum = initial.col(i).cast<double>().sum();
    if (!initial.col(i).allFinite() || initial.col(i).minCoeff() < 0.0f)
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "marginals to start from: variable "
                              << i << " has a negative or non-finite one");
    if (sum > 0.0)
      for (Eigen::Index l = 0; l < initial.rows(); ++l)
        marginals_.column(i)[l] = float(double(initial(l, i)) / sum);
  }
}

void
MeanField::Engine::hear(const VariableMask& active)
{
  for (const auto& kernel : model_.kernels)
    kernel->addProduct(marginals_.view(), messages_.view(), active);
}

double
MeanField::Engine::finish(Eigen::Index begin, Eigen::Index end)
{
  const Eigen::Index stride = messages_.stride();
  for (Eigen::Index i = begin; i < end; ++i) {
    auto message = messages_.view().col(i);
    if (!self_responses_.empty())
      message += self_responses_[std::size_t(i)] * marginals_.view().col(i);
    if (compatibility_.columns() > 0)
      message =
          (-compatibility_.view() * message.head(compatibility_.columns())).eval();
  }
  for (const auto& term : terms_)
    term->addMessages(marginals_, begin, end, messages_);
  return double(softMax(costs_.column(begin), messages_.column(begin),
                        marginals_.column(begin), std::size_t(end - begin),
                        std::size_t(stride)));
}

double
MeanField::Engine::update()
{
  double change = 0.0;
  for (const auto& term : terms_)
    change = std::max(change, term->update(marginals_));
  hear({});
  const Eigen::Index count = marginals_.columns();
#pragma omp parallel for schedule(static) reduction(max : change)
  for (Eigen::Index begin = 0; begin < count; begin += block_size)
    change = std::max(change, finish(begin, std::min(count, begin + block_size)));
  return change;
}

double
MeanField::Engine::updateSequentially()
{
  requireSymmetry("sequential updates");
  requireMatrices(model_.kernels);
  for (const CliquePotential& potential : model_.cliques)
    requireMatrices(potential.kernels);
  double change = 0.0;
  for (const auto& term : terms_)
    change = std::max(change, term->updateSequentially(marginals_));
  VariableMask active(std::size_t(marginals_.columns()), 0);
  for (Eigen::Index i = 0; i < marginals_.columns(); ++i) {
    active[std::size_t(i)] = 1;
    messages_.setZero();
    hear(active);
    change = std::max(change, finish(i, i + 1));
    active[std::size_t(i)] = 0;
    for (const auto& term : terms_)
      term->variableChanged(i, marginals_);
  }
  messages_.setZero();
  return change;
}

void
MeanField::Engine::requireSymmetry(const char* purpose) const
{
  if (!model_.compatibility.isSymmetric())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        purpose << " need a symmetric label compatibility");
}

const PaddedColumns*
MeanField::Engine::cliqueMarginals(std::size_t potential) const
{
  const PaddedColumns* const result =
      potential < terms_.size() ? terms_[potential]->cliqueMarginals() : nullptr;
  if (!result)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "clique potential " << potential
                                            << " has no variables of its own");
  return result;
}

double
MeanField::Engine::freeEnergy() const
{
  requireSymmetry("free energies");
  PaddedColumns heard(marginals_.rows(), marginals_.columns());
  for (const auto& kernel : model_.kernels)
    kernel->addProduct(marginals_.view(), heard.view(), {});
  double sum = offset_;
  for (Eigen::Index i = 0; i < marginals_.columns(); ++i) {
    const float* const q = marginals_.column(i);
    for (Eigen::Index l = 0; l < marginals_.rows(); ++l) {
      double pairs = 0.0;
      for (Eigen::Index k = 0; k < marginals_.rows(); ++k)
        pairs += double(model_.compatibility.cost(l, k)) * double(heard.column(i)[k]);
      if (q[l] > 0.0f)
        sum += double(q[l]) *
               (double(costs_.column(i)[l]) + 0.5 * pairs + std::log(double(q[l])));
    }
  }
  for (const auto& term : terms_)
    sum += term->freeEnergy(marginals_);
  return sum;
}

} // namespace pcl_semantic
