// SPDX-License-Identifier: BSD-3-Clause

// Updates against the plain double-precision implementation, and the edges of the
// interface.

#include "support/plain_mean_field.h"
#include "support/random_crf.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/mean_field.h>

#include <gtest/gtest.h>

namespace {

using namespace pcl_semantic;
using Type = CliquePotential::Type;

double
largestDifference(const Eigen::MatrixXf& ours, const Eigen::MatrixXd& expected)
{
  EXPECT_EQ(ours.rows(), expected.rows());
  EXPECT_EQ(ours.cols(), expected.cols());
  return ours.size() > 0 ? (ours.cast<double>() - expected).cwiseAbs().maxCoeff() : 0.0;
}

void
expectSameUpdates(const PlainCrf& crf, int updates)
{
  MeanField inference(makeModel(crf));
  PlainMeanField plain(crf);
  for (int update = 0; update <= updates; ++update) {
    SCOPED_TRACE("after " + std::to_string(update) + " updates");
    ASSERT_LT(largestDifference(inference.marginals(), plain.q), 1e-5);
    for (std::size_t p = 0; p < crf.cliques.size(); ++p)
      if (crf.cliques[p].isRobust()) {
        ASSERT_LT(largestDifference(inference.cliqueMarginals(p), plain.q_cliques[p]),
                  1e-5);
      }
    plain.update();
    inference.update();
  }
}

TEST(MeanField, UpdatesOfEveryModelEqualAPlainImplementation)
{
  for (const int labels : {1, 2, 5, 8, 11, 16, 17})
    for (const NamedCrf& model :
         makeEveryModel(40, labels, 9, 3.0f, unsigned(labels))) {
      SCOPED_TRACE(model.name + ", " + std::to_string(labels) + " labels");
      expectSameUpdates(model.crf, 5);
    }
}

TEST(MeanField, UpdatesWithSelfInteractionEqualAPlainImplementation)
{
  for (NamedCrf& model : makeEveryModel(40, 6, 9, 3.0f, 50)) {
    SCOPED_TRACE(model.name);
    model.crf.self_interaction = true;
    expectSameUpdates(model.crf, 4);
  }
}

TEST(MeanField, StartsFromCliquesAsAPlainImplementation)
{
  for (const int labels : {1, 6, 8, 16})
    for (NamedCrf& model : makeEveryModel(40, labels, 9, 3.0f, 60)) {
      SCOPED_TRACE(model.name + ", " + std::to_string(labels) + " labels");
      model.crf.start_from_cliques = true;
      expectSameUpdates(model.crf, 4);
    }
}

TEST(MeanField, UpdatesWithKernelsAndCompatibilitiesThatAreNotSymmetric)
{
  PlainCrf crf;
  crf.unary = makeRandomMatrix(4, 30, 0.0f, 3.0f, 1);
  crf.kernels.push_back(makeRandomMatrix(30, 30, 0.0f, 0.2f, 2));
  expectSameUpdates(crf, 4);
  crf.compatibility = makeRandomMatrix(4, 4, -1.0f, 1.0f, 3);
  expectSameUpdates(crf, 4);
}

TEST(MeanField, ManyLabels)
{
  for (const int labels : {100, 255}) // 256 with the free label
    for (const NamedCrf& model : makeEveryModel(6, labels, 4, 3.0f, 70)) {
      SCOPED_TRACE(model.name);
      expectSameUpdates(model.crf, 2);
    }
}

// Costs that no float can hold the difference or the sum of.
TEST(MeanField, LargeCosts)
{
  PlainCrf crf;
  crf.unary = makeRandomMatrix(5, 20, -1e4f, 1e4f, 1);
  crf.unary.col(3) << 3e38f, -3e38f, 3e38f, 0.0f, -3e38f;
  crf.unary.col(4).setConstant(3e38f);
  crf.unary.col(5) << 3e38f, -3e38f, 3e38f, 3e38f, 3e38f;
  crf.unary.col(6) << -3e38f, 3e38f, 3e38f, 3e38f, 3e38f;
  PlainCliques cliques;
  cliques.members = {{5, 6}, {7, 8}};
  crf.cliques.push_back(cliques);
  expectSameUpdates(crf, 2);
}

// Sums over the members of a large clique must not lose what single members say.
TEST(MeanField, LargeCliques)
{
  PlainCrf crf;
  crf.unary = makeRandomMatrix(3, 30000, 0.0f, 3.0f, 1);
  crf.unary.row(1) = crf.unary.row(0).reverse(); // labels 0 and 1 tie
  crf.unary.row(2).setConstant(2.5f);
  crf.unary(0, 7) -= 0.5f;
  PlainCliques cliques;
  cliques.members.emplace_back(30000);
  std::iota(cliques.members[0].begin(), cliques.members[0].end(), 0);
  cliques.truncation = 1.0f;
  crf.cliques.push_back(cliques);
  expectSameUpdates(crf, 2);
}

// Members that are certain of other labels than the rest: products with zeros.
TEST(MeanField, PnPottsWithProbabilitiesOfZero)
{
  PlainCrf crf;
  crf.unary = makeRandomMatrix(4, 12, 0.0f, 1.0f, 1);
  crf.unary(0, 0) = crf.unary(1, 1) = crf.unary(1, 2) = 1e4f;
  crf.unary(2, 3) = 90.0f; // a probability below the normal floats
  crf.unary(3, 6) = 50.0f;
  crf.unary.col(5) << 0.0f, 1e4f, 1e4f, 1e4f;
  PlainCliques cliques;
  cliques.type = Type::pn_potts;
  cliques.weights = Eigen::MatrixXf::Constant(1, 1, 60.0f);
  cliques.members = {{0, 4, 6}, {1, 2, 7}, {3, 8, 9}, {5, 10}, {1, 11}, {3}};
  crf.cliques.push_back(cliques);
  expectSameUpdates(crf, 5);
}

TEST(MeanField, PnPottsOfLargeCliques)
{
  PlainCrf crf;
  crf.unary = makeRandomMatrix(3, 5000, 0.0f, 3.0f, 1);
  crf.unary.rightCols(4000).row(1).array() += 20.0f; // nearly certain of label 0 or 2
  crf.unary.rightCols(4000).row(2).array() += 20.0f;
  PlainCliques cliques;
  cliques.type = Type::pn_potts;
  cliques.members.resize(2);
  for (int i = 0; i < 5000; ++i)
    cliques.members[i < 1000 ? 0 : 1].push_back(i);
  crf.cliques.push_back(cliques);
  expectSameUpdates(crf, 3);
}

TEST(MeanField, NoVariablesAndNoCliques)
{
  CrfModel model;
  model.unary.resize(3, 0);
  model.kernels.push_back(std::make_shared<MatrixKernel>(Eigen::MatrixXf(0, 0)));
  model.cliques.emplace_back();
  model.cliques[0].cliques = std::make_shared<CliqueSet>();
  model.self_interaction = true;
  MeanField inference(model);
  inference.update();
  EXPECT_EQ(inference.marginals().rows(), 3);
  EXPECT_EQ(inference.marginals().cols(), 0);
  EXPECT_EQ(inference.cliqueMarginals().rows(), 4);
}

TEST(MeanField, SeveralUpdatesAreOneAfterTheOther)
{
  const CrfModel model = makeModel(makeEveryModel(30, 4, 6, 0.5f, 82)[6].crf);
  MeanField by_hand(model), inference(model);
  for (int update = 0; update < 3; ++update)
    by_hand.update();
  inference.run(3);
  EXPECT_EQ(inference.marginals(), by_hand.marginals());
  inference.run(0);
  EXPECT_EQ(inference.marginals(), by_hand.marginals());
  EXPECT_THROW(inference.run(-1), InvalidParameterException);
}

TEST(MeanField, MarginalsOfCliquesThatAreNotThere)
{
  const MeanField dense(makeModel(makeEveryModel(10, 3, 2, 1.0f, 83)[1].crf));
  expectBadParameter("potential 0", [&] { (void)dense.cliqueMarginals(); });
  const MeanField potts(makeModel(makeEveryModel(10, 3, 2, 1.0f, 83)[3].crf));
  EXPECT_THROW((void)potts.cliqueMarginals(), InvalidParameterException);
  const MeanField robust(makeModel(makeEveryModel(10, 3, 2, 1.0f, 83)[5].crf));
  EXPECT_THROW((void)robust.cliqueMarginals(1), InvalidParameterException);
}

} // namespace
