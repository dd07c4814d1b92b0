// SPDX-License-Identifier: BSD-3-Clause
#include "crf/crf_energy.h"
#include "support/plain_crf.h"
#include "support/random_crf.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>

#include <gtest/gtest.h>

namespace {

using namespace pcl_semantic;
using Labels = std::vector<int>;

// The labels of the cliques of least energy, one after the other: no kernels link them.
Labels
bestCliqueLabels(const CrfModel& model, const Labels& x)
{
  Labels y;
  for (const CliquePotential& potential : model.cliques)
    if (potential.type == CliquePotential::Type::robust)
      y.resize(y.size() + potential.cliques->size(), 0);
  const int labels = int(model.unary.rows());
  for (int& label : y) {
    std::vector<double> energies;
    for (label = 0; label < labels + int(model.cliques[0].free_label); ++label)
      energies.push_back(energy(model, x, y));
    label = int(std::min_element(energies.begin(), energies.end()) - energies.begin());
  }
  return y;
}

double
energy(const CrfModel& model, const Labels& x)
{
  return energy(model, x, bestCliqueLabels(model, x));
}

TEST(CrfEnergy, EqualsItsDefinitionForAllLabellings)
{
  for (const NamedCrf& model : makeEveryModel(4, 2, 2, 2.0f, 1)) {
    SCOPED_TRACE(model.name);
    const CrfModel ours = makeModel(model.crf);
    forEachLabelling(model.crf, [&](const Labels& x, const Labels& y) {
      ASSERT_NEAR(energy(ours, x, y), plainEnergy(model.crf, x, y), 1e-5);
    });
  }
}

TEST(CrfEnergy, KnowsNoSelfInteraction)
{
  PlainCrf crf = makeEveryModel(6, 3, 2, 2.0f, 2)[1].crf;
  const Labels x{0, 1, 2, 2, 1, 0};
  const double without = energy(makeModel(crf), x);
  crf.self_interaction = true;
  EXPECT_EQ(energy(makeModel(crf), x), without);
}

TEST(CrfEnergy, TakesTheSymmetricPartOfAKernel)
{
  PlainCrf crf;
  crf.unary = Eigen::MatrixXf::Zero(2, 2);
  crf.kernels.emplace_back(2, 2);
  crf.kernels[0] << 7.0f, 1.0f, 3.0f, 7.0f;
  EXPECT_NEAR(energy(makeModel(crf), {0, 1}), 2.0, 1e-6);
}

// min(gamma_max, min over l of k^l (number of members that do not take l) + psi_c(l))
double
truncatedLinear(const PlainCrf& crf, const Labels& x)
{
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    sum += double(crf.unary(x[i], Eigen::Index(i)));
  for (const PlainCliques& cliques : crf.cliques)
    for (std::size_t c = 0; c < cliques.members.size(); ++c) {
      const auto& members = cliques.members[c];
      double largest = 0.0;
      for (int l = 0; l < crf.labels(); ++l)
        largest = std::max(largest, cliques.weight(l, c));
      double least = cliques.free_label
                         ? double(cliques.truncation) * double(members.size()) * largest
                         : INFINITY;
      for (int l = 0; l < crf.labels(); ++l) {
        const auto others =
            std::count_if(members.begin(), members.end(),
                          [&](std::int32_t i) { return x[std::size_t(i)] != l; });
        least = std::min(least, cliques.weight(l, c) * double(others) +
                                    double(cliques.unary(l, Eigen::Index(c))));
      }
      sum += least;
    }
  return sum;
}

TEST(CrfEnergy, RobustPotentialIsTruncatedLinearAfterMinimisingOverItsCliques)
{
  for (const bool free_label : {true, false})
    for (const int weight_rows : {1, 3})
      for (const int weight_columns : {1, 4}) {
        PlainCrf crf;
        crf.unary = makeRandomMatrix(3, 8, 0.0f, 1.0f, 3);
        PlainCliques cliques;
        cliques.members = {{0, 1, 2, 3, 4, 5, 6}, {7}, {2, 3, 7}, {0, 7, 5, 4, 1}};
        cliques.weights = makeRandomMatrix(weight_rows, weight_columns, 0.1f, 2.0f, 4);
        cliques.free_label = free_label;
        cliques.truncation = 0.4f;
        cliques.unary = makeRandomMatrix(3, 4, 0.0f, 0.5f, 5);
        crf.cliques.push_back(cliques);
        const CrfModel model = makeModel(crf);
        bool let_go = false;
        std::mt19937 random(6);
        for (int trial = 0; trial < 300; ++trial) {
          Labels x(8);
          for (int& label : x)
            label = int(random() % 3);
          ASSERT_NEAR(energy(model, x), truncatedLinear(crf, x), 1e-5);
          for (const int y : bestCliqueLabels(model, x))
            let_go = let_go || y == 3;
        }
        EXPECT_EQ(let_go, free_label);
      }
}

// With one weight for all labels and no unary the share of members that may disagree
// is q: above, a clique pays the same however many more disagree.
TEST(CrfEnergy, TruncationIsTheShareThatMayDisagree)
{
  PlainCrf crf;
  crf.unary = Eigen::MatrixXf::Zero(2, 10);
  PlainCliques cliques;
  cliques.members.resize(1);
  for (std::int32_t i = 0; i < 10; ++i)
    cliques.members[0].push_back(i);
  cliques.weights = Eigen::MatrixXf::Constant(1, 1, 2.0f);
  cliques.truncation = 0.3f;
  crf.cliques.push_back(cliques);
  const CrfModel model = makeModel(crf);
  Labels x(10, 0);
  for (int disagree = 0; disagree <= 5; ++disagree) {
    EXPECT_NEAR(energy(model, x), 2.0 * std::min(disagree, 3), 1e-5);
    x[std::size_t(disagree)] = 1;
  }
}

TEST(CrfEnergy, PnPottsWantsAllMembersToAgree)
{
  PlainCrf crf;
  crf.unary = Eigen::MatrixXf::Zero(2, 3);
  PlainCliques cliques;
  cliques.type = CliquePotential::Type::pn_potts;
  cliques.members = {{0, 1, 2}};
  cliques.weights.resize(2, 1);
  cliques.weights << 1.0f, 3.0f;
  crf.cliques.push_back(cliques);
  const CrfModel model = makeModel(crf);
  EXPECT_FLOAT_EQ(float(energy(model, {0, 0, 0})), 2.0f);
  EXPECT_FLOAT_EQ(float(energy(model, {1, 1, 1})), 0.0f);
  EXPECT_FLOAT_EQ(float(energy(model, {1, 0, 1})), 3.0f);
}

TEST(CrfEnergy, RefusesWhatIsNoLabelling)
{
  const PlainCrf crf = makeEveryModel(4, 3, 2, 1.0f, 7)[6].crf;
  const auto refusal = [](const CrfModel& model, const Labels& x, const Labels& y) {
    return thrownMessage<InvalidParameterException>([&] { (void)energy(model, x, y); });
  };
  const CrfModel model = makeModel(crf);
  EXPECT_NO_THROW((void)energy(model, {0, 1, 2, 0}, {0, 3}));
  EXPECT_TRUE(holds(refusal(model, {0, 1, 2}, {0, 3}), "3 labels, expected 4"));
  EXPECT_TRUE(holds(refusal(model, {0, 1, 3, 0}, {0, 3}), "variable 2 is 3"));
  EXPECT_TRUE(holds(refusal(model, {0, 1, -1, 0}, {0, 3}), "variable 2 is -1"));
  EXPECT_TRUE(holds(refusal(model, {0, 1, 2, 0}, {0}), "1 labels of cliques"));
  EXPECT_TRUE(holds(refusal(model, {0, 1, 2, 0}, {0, 4}), "clique 1 is 4"));
  EXPECT_TRUE(holds(refusal(model, {0, 1, 2, 0}, {-1, 0}), "clique 0 is -1"));

  PlainCrf bound = crf;
  bound.cliques[0].free_label = false;
  EXPECT_TRUE(holds(refusal(makeModel(bound), {0, 1, 2, 0}, {0, 3}), "clique 1 is 3"));
  PlainCrf lopsided = crf;
  lopsided.compatibility = makeRandomMatrix(3, 3, 0.0f, 1.0f, 8);
  EXPECT_TRUE(
      holds(refusal(makeModel(lopsided), {0, 1, 2, 0}, {0, 3}), "symmetric label"));
  CrfModel broken = model;
  broken.unary(0, 0) = NAN;
  EXPECT_TRUE(holds(refusal(broken, {0, 1, 2, 0}, {0, 3}), "not finite"));
}

} // namespace
