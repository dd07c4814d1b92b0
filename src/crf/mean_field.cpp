// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/crf/mean_field.h>

#include "clique_term.h"
#include "core/fail.h"
#include "kernels/inference_loops.h"

#include <algorithm>
#include <vector>

namespace pcl_semantic {

namespace {

// Variables per block: their costs, messages and marginals stay in the cache.
constexpr Eigen::Index block_size = 64;

void
shiftCosts(const float* costs, Eigen::Index labels, Eigen::Index stride, float* shifted)
{
  float least = costs[0];
  for (Eigen::Index l = 1; l < labels; ++l)
    least = std::min(least, costs[l]);
  for (Eigen::Index l = 0; l < labels; ++l)
    shifted[l] = std::min(costs[l] - least, kernels::padding_cost);
  for (Eigen::Index l = labels; l < stride; ++l)
    shifted[l] = kernels::padding_cost;
}

} // namespace

/** \brief Mean-field inference on padded columns. Messages are negative costs, -sum_j
 * K_ij Q_j(l), so that softMax() computes costs minus messages. */
class MeanField::Engine {
public:
  explicit Engine(CrfModel&& model)
      : kernels_(std::move(model.kernels)),
        compatibility_(std::move(model.compatibility))
  {
    setUp(model.unary);
    setUpPairs(model);
    for (CliquePotential& potential : model.cliques)
      terms_.push_back(
          makeCliqueTerm(std::move(potential), model.self_interaction, costs_));
    if (model.start_from_cliques)
      startFromCliques();
  }

  /** \brief One iteration: every Q(y_c) from the Q(x_i), then every Q(x_i) from both.
   */
  void
  update()
  {
    for (const auto& term : terms_) // Q(y_c), eq. (10)
      term->update(marginals_);
    for (const auto& kernel : kernels_) // message passing: sum_j K_ij Q_j(l), eq. (6)
      kernel->addProduct(marginals_.view(), messages_.view());
    const Eigen::Index count = marginals_.columns();
#pragma omp parallel for schedule(static) if (count > block_size)
    for (Eigen::Index begin = 0; begin < count; begin += block_size)
      updateMarginals(begin, std::min(count, begin + block_size));
  }

  const PaddedColumns&
  marginals() const
  {
    return marginals_;
  }

  const PaddedColumns*
  cliqueMarginals(std::size_t potential) const
  {
    return potential < terms_.size() ? terms_[potential]->cliqueMarginals() : nullptr;
  }

private:
  // Costs and start in one pass over new memory.
  void
  setUp(const Eigen::MatrixXf& unary)
  {
    const Eigen::Index labels = unary.rows(), count = unary.cols();
    costs_ = PaddedColumns(labels, count);
    marginals_ = PaddedColumns(labels, count);
    messages_ = PaddedColumns(labels, count);
    const Eigen::Index stride = costs_.stride();
#pragma omp parallel for schedule(dynamic, 8) if (count > 8 * block_size)
    for (Eigen::Index begin = 0; begin < count; begin += block_size) {
      const Eigen::Index size = std::min(block_size, count - begin);
      for (Eigen::Index i = begin; i < begin + size; ++i)
        shiftCosts(unary.data() + i * labels, labels, stride, costs_.column(i));
      std::fill_n(messages_.column(begin), size * stride, 0.0f);
      kernels::inferenceLoops().softMax(costs_.column(begin), messages_.column(begin),
                                        marginals_.column(begin), std::size_t(size),
                                        std::size_t(stride));
    }
  }

  void
  setUpPairs(const CrfModel& model)
  {
    const Eigen::Index labels = marginals_.rows();
    if (!compatibility_.isPotts()) {
      mixing_ = PaddedColumns(labels, labels);
      mixing_.setZero();
      for (Eigen::Index k = 0; k < labels; ++k)
        for (Eigen::Index l = 0; l < labels; ++l)
          mixing_.column(k)[l] = compatibility_.cost(l, k);
    }
    if (!model.self_interaction)
      return;
    self_responses_.assign(std::size_t(marginals_.columns()), 0.0f);
#pragma omp parallel for schedule(static)
    for (Eigen::Index i = 0; i < marginals_.columns(); ++i)
      for (const auto& kernel : kernels_)
        self_responses_[std::size_t(i)] += kernel->diagonal(i);
  }

  // Eqs. (10) and (11) without the kernels between variables.
  void
  startFromCliques()
  {
    for (const auto& term : terms_)
      term->update(marginals_);
    const Eigen::Index count = marginals_.columns();
#pragma omp parallel for schedule(static) if (count > block_size)
    for (Eigen::Index begin = 0; begin < count; begin += block_size) {
      const Eigen::Index end = std::min(count, begin + block_size);
      for (const auto& term : terms_)
        term->addMessages(marginals_, begin, end, messages_);
      kernels::inferenceLoops().softMax(
          costs_.column(begin), messages_.column(begin), marginals_.column(begin),
          std::size_t(end - begin), std::size_t(messages_.stride()));
    }
  }

  // Q(x_i), eq. (11), for a block of variables.
  void
  updateMarginals(Eigen::Index begin, Eigen::Index end)
  {
    const auto count = std::size_t(end - begin);
    const auto stride = std::size_t(messages_.stride());
    if (!self_responses_.empty()) // j = i, which the kernels omit
      for (Eigen::Index i = begin; i < end; ++i)
        for (std::size_t l = 0; l < stride; ++l)
          messages_.column(i)[l] +=
              self_responses_[std::size_t(i)] * marginals_.column(i)[l];
    if (mixing_.columns() > 0) // compatibility transform: sum_k mu(l, k), eq. (5)
      kernels::inferenceLoops().mixLabels(mixing_.column(0),
                                          std::size_t(mixing_.columns()),
                                          messages_.column(begin), count, stride);
    for (const auto& term : terms_) // messages of the cliques, eqs. (7)-(8)
      term->addMessages(marginals_, begin, end, messages_);
    // Local update and normalisation: exp(-psi_i(l) + message), eq. (4).
    kernels::inferenceLoops().softMax(costs_.column(begin), messages_.column(begin),
                                      marginals_.column(begin), count, stride);
  }

  std::vector<std::shared_ptr<const PairwiseKernel>> kernels_;
  LabelCompatibility compatibility_;
  PaddedColumns costs_;               // psi_i(l) minus their minimum over l
  PaddedColumns marginals_;           // Q(x)
  PaddedColumns messages_;            // zero between updates
  PaddedColumns mixing_;              // mu(l, k), column k; empty = Potts
  std::vector<float> self_responses_; // sum of K_ii; empty = none
  std::vector<std::unique_ptr<CliqueTerm>> terms_;
};

MeanField::MeanField(CrfModel model)
{
  model.validate();
  engine_ = std::make_unique<Engine>(std::move(model));
}

MeanField::~MeanField() = default;
MeanField::MeanField(MeanField&&) noexcept = default;
MeanField& MeanField::operator=(MeanField&&) noexcept = default;

void
MeanField::update()
{
  engine_->update();
}

void
MeanField::run(int updates)
{
  if (updates < 0)
    badParameter("updates are ", updates, ", expected 0 or more");
  for (int i = 0; i < updates; ++i)
    update();
}

MeanField::Marginals
MeanField::marginals() const
{
  return engine_->marginals().view().topRows(engine_->marginals().rows());
}

Eigen::MatrixXf
MeanField::cliqueMarginals(std::size_t potential) const
{
  const PaddedColumns* const marginals = engine_->cliqueMarginals(potential);
  if (!marginals)
    badParameter("clique potential ", potential, " has no variables of its own");
  return marginals->matrix();
}

} // namespace pcl_semantic
