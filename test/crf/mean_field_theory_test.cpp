// SPDX-License-Identifier: BSD-3-Clause

// What mean field has to do by its theory: approach exact marginals, lower the free
// energy, and not care for the order of anything.

#include "support/plain_crf.h"
#include "support/plain_mean_field.h"
#include "support/random_crf.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/crf/mean_field.h>

#include <gtest/gtest.h>

namespace {

using namespace pcl_semantic;

double
errorOfMeanField(const PlainCrf& crf)
{
  MeanField inference(makeModel(crf));
  inference.run(300);
  return (inference.marginals().cast<double>() - exactMarginals(crf))
      .cwiseAbs()
      .maxCoeff();
}

// Mean field is exact to first order in the couplings.
TEST(MeanFieldTheory, HalvingAllCouplingsAtLeastThirdsTheError)
{
  for (const unsigned seed : {1u, 2u, 3u}) {
    const auto strong = makeEveryModel(4, 3, 2, 0.6f, seed);
    const auto weak = makeEveryModel(4, 3, 2, 0.3f, seed);
    for (std::size_t m = 1; m < strong.size(); ++m) { // 0 has no couplings
      SCOPED_TRACE(strong[m].name + ", seed " + std::to_string(seed));
      const double error = errorOfMeanField(strong[m].crf);
      EXPECT_GT(error, 1e-4);
      EXPECT_LT(errorOfMeanField(weak[m].crf), error / 3.0);
    }
    EXPECT_LT(errorOfMeanField(strong[0].crf), 1e-6);
  }
}

double
freeEnergyAfter(int updates, const PlainCrf& crf)
{
  MeanField inference(makeModel(crf));
  inference.run(updates);
  std::vector<Eigen::MatrixXd> q_cliques;
  for (std::size_t p = 0; p < crf.cliques.size(); ++p)
    q_cliques.push_back(crf.cliques[p].isRobust()
                            ? inference.cliqueMarginals(p).cast<double>()
                            : Eigen::MatrixXd());
  return enumeratedFreeEnergy(crf, inference.marginals().cast<double>(), q_cliques);
}

TEST(MeanFieldTheory, UpdatesLowerTheFreeEnergy)
{
  const auto models = makeEveryModel(4, 3, 2, 0.6f, 10);
  for (std::size_t m = 1; m < models.size(); ++m) { // 0 has no couplings
    SCOPED_TRACE(models[m].name);
    const double before = freeEnergyAfter(0, models[m].crf);
    const double once = freeEnergyAfter(1, models[m].crf);
    EXPECT_LT(once, before);
    EXPECT_LT(freeEnergyAfter(3, models[m].crf), once);
  }
}

// new_order[i] is where i goes.
template <typename Index>
std::vector<Index>
makeOrder(int count, unsigned seed)
{
  std::vector<Index> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  return order;
}

// Rows and columns (where asked) to their new places.
Eigen::MatrixXf
permuted(const Eigen::MatrixXf& matrix, const std::vector<int>* rows,
         const std::vector<int>* columns)
{
  Eigen::MatrixXf result(matrix.rows(), matrix.cols());
  for (Eigen::Index j = 0; j < matrix.cols(); ++j)
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
      result(rows && matrix.rows() > 1 ? (*rows)[std::size_t(i)] : i,
             columns && matrix.cols() > 1 ? (*columns)[std::size_t(j)] : j) =
          matrix(i, j);
  return result;
}

PlainCrf
permuteVariables(PlainCrf crf, const std::vector<int>& order)
{
  crf.unary = permuted(crf.unary, nullptr, &order);
  for (Eigen::MatrixXf& kernel : crf.kernels)
    kernel = permuted(kernel, &order, &order);
  for (PlainCliques& cliques : crf.cliques)
    for (auto& members : cliques.members) {
      for (std::int32_t& i : members)
        i = order[std::size_t(i)];
      std::reverse(members.begin(), members.end());
    }
  return crf;
}

PlainCrf
permuteLabels(PlainCrf crf, const std::vector<int>& order)
{
  crf.unary = permuted(crf.unary, &order, nullptr);
  crf.compatibility = permuted(crf.compatibility, &order, &order);
  for (PlainCliques& cliques : crf.cliques) {
    cliques.weights = permuted(cliques.weights, &order, nullptr);
  }
  return crf;
}

PlainCrf
permuteCliques(PlainCrf crf, unsigned seed)
{
  for (PlainCliques& cliques : crf.cliques) {
    const auto order = makeOrder<int>(int(cliques.members.size()), seed);
    const auto members = cliques.members;
    for (std::size_t c = 0; c < members.size(); ++c)
      cliques.members[std::size_t(order[c])] = members[c];
    cliques.weights = permuted(cliques.weights, nullptr, &order);
    for (Eigen::MatrixXf& kernel : cliques.kernels)
      kernel = permuted(kernel, &order, &order);
  }
  return crf;
}

TEST(MeanFieldTheory, TheOrderOfVariablesLabelsAndCliquesDoesNotMatter)
{
  const auto marginals = [](const PlainCrf& crf) -> Eigen::MatrixXf {
    MeanField inference(makeModel(crf));
    inference.run(5);
    return inference.marginals();
  };
  for (const NamedCrf& model : makeEveryModel(150, 11, 25, 5.0f, 40)) {
    SCOPED_TRACE(model.name);
    const Eigen::MatrixXf expected = marginals(model.crf);
    const auto error = [&](const Eigen::MatrixXf& other) {
      return (expected - other).cwiseAbs().maxCoeff();
    };
    const auto variables = makeOrder<int>(150, 1), labels = makeOrder<int>(11, 2);
    const Eigen::MatrixXf by_variables =
        marginals(permuteVariables(model.crf, variables));
    const Eigen::MatrixXf by_labels = marginals(permuteLabels(model.crf, labels));
    Eigen::MatrixXf back = expected;
    for (int i = 0; i < 150; ++i)
      back.col(i) = by_variables.col(variables[std::size_t(i)]);
    EXPECT_LT(error(back), 1e-5);
    for (int l = 0; l < 11; ++l)
      back.row(l) = by_labels.row(labels[std::size_t(l)]);
    EXPECT_LT(error(back), 1e-5);
    EXPECT_LT(error(marginals(permuteCliques(model.crf, 3))), 1e-5);
    // The permutations did something.
    EXPECT_GT(error(by_variables), 1e-2);
  }
}

TEST(MeanFieldTheory, SameBitsForAnyNumberOfThreads)
{
  for (NamedCrf& model : makeEveryModel(300, 11, 60, 5.0f, 41)) {
    SCOPED_TRACE(model.name);
    std::vector<Eigen::MatrixXf> marginals, cliques;
    for (const int threads : {1, 2, 7}) {
      setNumberOfThreads(threads);
      MeanField inference(makeModel(model.crf));
      inference.run(3);
      marginals.push_back(inference.marginals());
      cliques.push_back(model.crf.cliques.empty() || !model.crf.cliques[0].isRobust()
                            ? Eigen::MatrixXf()
                            : inference.cliqueMarginals());
    }
    setNumberOfThreads(0);
    for (const std::size_t k : {1u, 2u}) {
      EXPECT_TRUE(marginals[0] == marginals[k]);
      EXPECT_TRUE(cliques[0] == cliques[k]);
    }
  }
}

} // namespace
