// SPDX-License-Identifier: BSD-3-Clause

// Models that must be refused, and the parts they are made of.

#include "support/brute_force_crf.h"
#include "support/plain_crf.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/crf_model.h>
#include <pcl_semantic/crf/mean_field.h>

#include <gtest/gtest.h>

#include <functional>

namespace {

using namespace pcl_semantic;

CrfModel
makeGoodModel()
{
  CrfModel model;
  model.unary = makeRandomMatrix(3, 6, 0.0f, 1.0f, 1);
  model.kernels.push_back(
      std::make_shared<MatrixKernel>(makeRandomMatrix(6, 6, 0.0f, 1.0f, 2)));
  model.cliques.emplace_back();
  model.cliques[0].cliques = std::make_shared<CliqueSet>(
      std::vector<std::vector<std::int32_t>>{{0, 1, 2}, {3, 4}}, 6);
  model.cliques[0].kernels.push_back(
      std::make_shared<MatrixKernel>(makeRandomMatrix(2, 2, 0.0f, 1.0f, 3)));
  return model;
}

struct BadModel {
  std::function<void(CrfModel&)> damage;
  std::string says;
};

TEST(CrfModel, RefusesWhatCannotWork)
{
  const auto kernel = [](int size) {
    return std::make_shared<MatrixKernel>(Eigen::MatrixXf::Ones(size, size));
  };
  using Matrix = Eigen::MatrixXf;
  const std::vector<BadModel> cases = {
      {[](CrfModel& m) { m.unary(1, 4) = NAN; }, "variable 4 is not finite"},
      {[](CrfModel& m) { m.unary(2, 0) = INFINITY; }, "variable 0 is not finite"},
      {[](CrfModel& m) { m.unary(0, 5) = -INFINITY; }, "variable 5 is not finite"},
      {[](CrfModel& m) { m.unary.resize(0, 6); }, "0 classes, expected 1 to 255"},
      {[](CrfModel& m) { m.unary.resize(0, 0); }, "0 classes, expected 1 to 255"},
      {[](CrfModel& m) { m.unary = Matrix::Zero(256, 6); }, "256 classes"},
      {[](CrfModel& m) { m.unary = Matrix::Zero(3, 5); }, "expected one over 5"},
      {[&](CrfModel& m) { m.kernels.push_back(kernel(7)); }, "a kernel is over 7"},
      {[](CrfModel& m) { m.kernels.push_back(nullptr); }, "a kernel is missing"},
      {[](CrfModel& m) { m.compatibility = LabelCompatibility(Matrix::Ones(4, 4)); },
       "of 4 classes, expected 3"},
      {[](CrfModel& m) { m.cliques[0].cliques = nullptr; }, "has no cliques"},
      {[](CrfModel& m) {
         m.cliques[0].cliques = std::make_shared<CliqueSet>(
             std::vector<std::vector<std::int32_t>>{{0, 1}, {2}}, 7);
       },
       "over 7 variables, expected 6"},
      {[](CrfModel& m) { m.cliques[0].weights = Matrix::Ones(2, 1); }, "2 x 1"},
      {[](CrfModel& m) { m.cliques[0].weights = Matrix::Ones(1, 3); }, "1 x 3"},
      {[](CrfModel& m) { m.cliques[0].weights = Matrix(); }, "0 x 0"},
      {[](CrfModel& m) { m.cliques[0].weights(0, 0) = -1.0f; }, "clique 0 is -1"},
      {[](CrfModel& m) { m.cliques[0].weights(0, 0) = NAN; }, "expected 0 to 1e9"},
      {[](CrfModel& m) { m.cliques[0].weights(0, 0) = INFINITY; }, "clique 0 is inf"},
      {[](CrfModel& m) { m.cliques[0].truncation = 0.0f; }, "truncation is 0"},
      {[](CrfModel& m) { m.cliques[0].truncation = 1.1f; }, "truncation is 1.1"},
      {[](CrfModel& m) { m.cliques[0].truncation = NAN; }, "truncation is"},
      {[&](CrfModel& m) { m.cliques[0].kernels.push_back(kernel(3)); },
       "between cliques is over 3, expected one over 2"},
      {[](CrfModel& m) { m.cliques[0].kernels.push_back(nullptr); },
       "between cliques is missing"},
      {[](CrfModel& m) { m.cliques[0].type = CliquePotential::Type::pn_potts; },
       "need the robust potential"},
  };
  EXPECT_NO_THROW(MeanField{makeGoodModel()});
  for (const BadModel& bad : cases) {
    CrfModel model = makeGoodModel();
    bad.damage(model);
    const std::string message =
        thrownMessage<InvalidParameterException>([&] { model.validate(); });
    EXPECT_TRUE(holds(message, bad.says));
    EXPECT_THROW(MeanField{model}, InvalidParameterException) << bad.says;
  }
}

TEST(LabelCompatibility, KnowsPottsAndItsCosts)
{
  const LabelCompatibility potts;
  EXPECT_TRUE(potts.isPotts());
  EXPECT_EQ(potts.labels(), 0);
  EXPECT_EQ(potts.cost(3, 3), 0.0f);
  EXPECT_EQ(potts.cost(3, 4), 1.0f);

  Eigen::MatrixXf costs = Eigen::MatrixXf::Ones(3, 3) - Eigen::MatrixXf::Identity(3, 3);
  EXPECT_TRUE(LabelCompatibility(costs).isPotts());
  EXPECT_EQ(LabelCompatibility(costs).labels(), 3);
  costs(0, 2) = costs(2, 0) = 0.5f;
  EXPECT_FALSE(LabelCompatibility(costs).isPotts());
  costs(0, 2) = 0.25f;
  const LabelCompatibility lopsided(costs);
  EXPECT_EQ(lopsided.cost(0, 2), 0.25f);
  EXPECT_EQ(lopsided.cost(2, 0), 0.5f);
}

TEST(LabelCompatibility, RefusesWhatIsNone)
{
  const auto refusal = [](const Eigen::MatrixXf& costs) {
    return thrownMessage<InvalidParameterException>(
        [&] { (void)LabelCompatibility(costs); });
  };
  EXPECT_TRUE(holds(refusal(Eigen::MatrixXf::Zero(3, 4)), "3 x 4"));
  EXPECT_TRUE(holds(refusal(Eigen::MatrixXf()), "0 x 0"));
  for (const float bad : {float(NAN), INFINITY, -INFINITY, 1e10f}) {
    Eigen::MatrixXf costs = Eigen::MatrixXf::Zero(3, 3);
    costs(1, 2) = bad;
    EXPECT_TRUE(holds(refusal(costs), "labels 1 and 2"));
  }
}

} // namespace
