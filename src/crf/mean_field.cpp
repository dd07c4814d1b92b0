// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/crf/mean_field.h>

#include "clique_term.h"
#include "core/fail.h"
#include "kernels/inference_loops.h"
#include "parallel_loops.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pcl_semantic {

namespace {

// Variables whose costs, messages and marginals stay in the fast cache together.
constexpr Eigen::Index block_size = 64;

// The costs less their minimum, which it returns.
double
shiftCosts(const float* costs, Eigen::Index labels, Eigen::Index stride, float* shifted)
{
  float least = costs[0];
  for (Eigen::Index l = 1; l < labels; ++l)
    least = std::min(least, costs[l]);
  for (Eigen::Index l = 0; l < labels; ++l)
    shifted[l] = std::min(costs[l] - least, kernels::padding_cost);
  for (Eigen::Index l = labels; l < stride; ++l)
    shifted[l] = kernels::padding_cost;
  return double(least);
}

} // namespace

/** \brief Mean-field inference on padded columns. Messages are negative costs, -sum_j
 * K_ij Q_j(l), so that softMax() takes costs less messages. */
class MeanField::Engine {
public:
  Engine(CrfModel&& model, const Eigen::MatrixXf* initial)
      : kernels_(std::move(model.kernels)),
        compatibility_(std::move(model.compatibility))
  {
    setUp(model.unary);
    setUpPairs(model);
    if (initial)
      start(*initial);
    for (CliquePotential& potential : model.cliques)
      terms_.push_back(
          makeCliqueTerm(std::move(potential), model.self_interaction, costs_));
  }

  /** \brief One iteration: every Q(y_c) from the Q(x_i), then every Q(x_i) from both.
   */
  double
  update()
  {
    double change = 0.0;
    for (const auto& term : terms_) // Q(y_c), eq. (10)
      change = std::max(change, term->update(marginals_));
    for (const auto& kernel : kernels_) // message passing: sum_j K_ij Q_j(l), eq. (6)
      kernel->addProduct(marginals_.view(), messages_.view());
    const Eigen::Index count = marginals_.columns();
#pragma omp parallel for schedule(static) reduction(max                                \
                                                    : change) if (count > block_size)
    for (Eigen::Index begin = 0; begin < count; begin += block_size)
      change =
          std::max(change, updateMarginals(begin, std::min(count, begin + block_size)));
    return change;
  }

  double
  freeEnergy() const
  {
    if (!compatibility_.isSymmetric())
      badParameter("a free energy needs a symmetric label compatibility");
    PaddedColumns messages(marginals_.rows(), marginals_.columns());
    messages.setZero();
    for (const auto& kernel : kernels_)
      kernel->addProduct(marginals_.view(), messages.view());
    double sum = offset_;
    sum += orderedSum(marginals_.columns(), 256, [&](Eigen::Index i) {
      double part = 0.0;
      for (Eigen::Index l = 0; l < marginals_.rows(); ++l) {
        const double q = marginals_.column(i)[l];
        if (q <= 0.0)
          continue;
        double pairs = 0.0; // each is met twice
        for (Eigen::Index k = 0; k < marginals_.rows(); ++k)
          pairs += double(compatibility_.cost(l, k)) * double(messages.column(i)[k]);
        part += q * (double(costs_.column(i)[l]) + 0.5 * pairs + std::log(q));
      }
      return part;
    });
    for (const auto& term : terms_)
      sum += term->freeEnergy(marginals_);
    return sum;
  }

  const PaddedColumns&
  marginals() const
  {
    return marginals_;
  }

  /** \brief Null where there are none. */
  const PaddedColumns*
  cliqueMarginals(std::size_t potential) const
  {
    return potential < terms_.size() ? terms_[potential]->cliqueMarginals() : nullptr;
  }

private:
  // Costs and start, in one pass over memory that is new.
  void
  setUp(const Eigen::MatrixXf& unary)
  {
    const Eigen::Index labels = unary.rows(), count = unary.cols();
    costs_ = PaddedColumns(labels, count);
    marginals_ = PaddedColumns(labels, count);
    messages_ = PaddedColumns(labels, count);
    const Eigen::Index stride = costs_.stride();
    offset_ =
        orderedSum((count + block_size - 1) / block_size, 8, [&](Eigen::Index block) {
          const Eigen::Index begin = block * block_size;
          const Eigen::Index size = std::min(block_size, count - begin);
          double sum = 0.0;
          for (Eigen::Index i = begin; i < begin + size; ++i)
            sum +=
                shiftCosts(unary.data() + i * labels, labels, stride, costs_.column(i));
          std::fill_n(messages_.column(begin), size * stride, 0.0f);
          std::fill_n(marginals_.column(begin), size * stride, 0.0f);
          kernels::inferenceLoops().softMax(
              costs_.column(begin), messages_.column(begin), marginals_.column(begin),
              std::size_t(size), std::size_t(stride));
          return sum;
        });
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

  void
  start(const Eigen::MatrixXf& initial)
  {
    if (initial.rows() != marginals_.rows() || initial.cols() != marginals_.columns())
      badParameter("marginals to start from are ", initial.rows(), " x ",
                   initial.cols(), ", expected ", marginals_.rows(), " x ",
                   marginals_.columns());
    for (Eigen::Index i = 0; i < initial.cols(); ++i) {
      double sum = 0.0;
      for (Eigen::Index l = 0; l < initial.rows(); ++l) {
        if (!(initial(l, i) >= 0.0f) || !std::isfinite(initial(l, i)))
          badParameter("marginals to start from: one of variable ", i, " is ",
                       initial(l, i), ", expected 0 or more");
        sum += double(initial(l, i));
      }
      for (Eigen::Index l = 0; l < initial.rows() && sum > 0.0; ++l) {
        const double q = double(initial(l, i)) / sum;
        marginals_.column(i)[l] = q > 1e-24 ? float(q) : 0.0f; // as soft-max does
      }
    }
  }

  // Q(x_i), eq. (11), for some variables, whose columns stay in the fast cache.
  double
  updateMarginals(Eigen::Index begin, Eigen::Index end)
  {
    const auto count = std::size_t(end - begin);
    const auto stride = std::size_t(messages_.stride());
    if (!self_responses_.empty()) // j = i, which the kernels leave out
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
    return double(
        kernels::inferenceLoops().softMax(costs_.column(begin), messages_.column(begin),
                                          marginals_.column(begin), count, stride));
  }

  std::vector<std::shared_ptr<const PairwiseKernel>> kernels_;
  LabelCompatibility compatibility_;
  PaddedColumns costs_;               // psi_i(l) less their minimum over l
  double offset_ = 0.0;               // the sum of the minima
  PaddedColumns marginals_;           // Q(x)
  PaddedColumns messages_;            // zero between updates
  PaddedColumns mixing_;              // mu(l, k), column k; empty = Potts
  std::vector<float> self_responses_; // sum of K_ii; empty = none are to be added
  std::vector<std::unique_ptr<CliqueTerm>> terms_;
};

MeanField::MeanField(CrfModel model, const Eigen::MatrixXf* initial)
{
  model.validate();
  engine_ = std::make_unique<Engine>(std::move(model), initial);
}

MeanField::~MeanField() = default;
MeanField::MeanField(MeanField&&) noexcept = default;
MeanField& MeanField::operator=(MeanField&&) noexcept = default;

double
MeanField::update()
{
  last_change_ = engine_->update();
  return last_change_;
}

int
MeanField::run(int max_updates, double tolerance)
{
  if (max_updates < 0)
    badParameter("updates are ", max_updates, ", expected 0 or more");
  if (!(tolerance >= 0.0))
    badParameter("the tolerance is ", tolerance, ", expected 0 or more");
  for (int i = 1; i <= max_updates; ++i)
    if (update() <= tolerance && tolerance > 0.0)
      return i;
  return max_updates;
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

double
MeanField::freeEnergy() const
{
  return engine_->freeEnergy();
}

} // namespace pcl_semantic
