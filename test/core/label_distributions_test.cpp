// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/label_distributions.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

using namespace pcl_semantic;

namespace {

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

// Positive weights over several orders of magnitude.
LabelDistributions::Matrix
randomWeights(int classes, int count, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> exponent(-6.0f, 1.0f);
  LabelDistributions::Matrix weights(classes, count);
  for (int j = 0; j < count; ++j)
    for (int k = 0; k < classes; ++k)
      weights(k, j) = std::pow(10.0f, exponent(random));
  return weights;
}

std::vector<float>
logOf(const float* distribution, int classes)
{
  std::vector<float> logs(classes);
  for (int k = 0; k < classes; ++k)
    logs[k] = std::log(distribution[k]);
  return logs;
}

} // namespace

TEST(LabelDistributions, HasOneTo255Classes)
{
  for (const int classes : {-1, 0, 256})
    expectBadParameter(std::to_string(classes),
                       [&] { LabelDistributions(classes, 1); });
  EXPECT_EQ(LabelDistributions(255, 2).classes(), 255);
  thrownMessage<InvalidParameterException>(
      [] { LabelDistributions(LabelDistributions::Matrix::Ones(256, 1)); });
  thrownMessage<InvalidParameterException>(
      [] { LabelDistributions(LabelDistributions::Matrix(0, 1)); });
  EXPECT_TRUE(LabelDistributions(4, 0).empty());
}

TEST(LabelDistributions, NormalizesEveryColumn)
{
  const LabelDistributions::Matrix weights = randomWeights(11, 1000, 1);
  const LabelDistributions distributions(weights);
  ASSERT_EQ(distributions.size(), 1000);
  for (int j = 0; j < 1000; ++j) {
    const double sum = weights.col(j).cast<double>().sum();
    for (int k = 0; k < 11; ++k)
      EXPECT_NEAR(distributions.matrix()(k, j), weights(k, j) / sum, 1e-6);
  }
}

TEST(LabelDistributions, ZeroColumnsStayZeroAndUnlabelled)
{
  LabelDistributions::Matrix weights = randomWeights(3, 3, 2);
  weights.col(1).setZero();
  const LabelDistributions distributions(weights);
  EXPECT_EQ(distributions.matrix().col(1), Eigen::Vector3f::Zero());
  EXPECT_EQ(distributions.mapLabel(1), kUnlabelled);
  EXPECT_NE(distributions.mapLabel(2), kUnlabelled);
}

TEST(LabelDistributions, NormalizesTheLargestAndSmallestFloats)
{
  LabelDistributions::Matrix weights(2, 2);
  weights << 3e38f, 1e-45f, 3e38f, 1e-45f;
  const LabelDistributions distributions(weights);
  EXPECT_TRUE(distributions.matrix().isConstant(0.5f)) << distributions.matrix();
}

TEST(LabelDistributions, NamesTheFirstBadColumn)
{
  for (const float bad : {-0.1f, not_a_number, infinity, -infinity}) {
    LabelDistributions::Matrix weights = randomWeights(5, 900, 3);
    weights(4, 417) = bad;
    weights(0, 803) = bad;
    EXPECT_TRUE(throws<BadInputException>("417", [&] {
      LabelDistributions d(weights);
    })) << bad;
  }
}

TEST(LabelDistributions, SetLabelSpreadsTheRestEvenly)
{
  LabelDistributions distributions(5, 2);
  distributions.setLabel(1, 2, 0.8f);
  const float expected[] = {0.05f, 0.8f, 0.05f, 0.05f, 0.05f};
  for (int k = 0; k < 5; ++k) {
    EXPECT_NEAR(distributions.matrix()(k, 1), expected[k], 1e-6);
    EXPECT_EQ(distributions.matrix()(k, 0), 0.0f);
  }
  EXPECT_EQ(distributions.mapLabel(1), 2);
  distributions.setLabel(1, kUnlabelled, 0.8f);
  EXPECT_TRUE(distributions.matrix().isZero());
  expectBadInput("6", [&] { distributions.setLabel(0, 6, 0.8f); });
  for (const float confidence : {-0.1f, 1.1f, not_a_number})
    thrownMessage<InvalidParameterException>(
        [&] { distributions.setLabel(0, 1, confidence); });

  LabelDistributions single(1, 1);
  single.setLabel(0, 1, 0.3f);
  EXPECT_EQ(single.matrix()(0, 0), 1.0f);
}

TEST(LabelDistributions, MapLabelTakesTheSmallestOfEquals)
{
  LabelDistributions::Matrix weights(4, 2);
  weights << 1, 1, 3, 1, 3, 1, 2, 1;
  const LabelDistributions distributions(weights);
  EXPECT_EQ(distributions.mapLabel(0), 2);
  EXPECT_EQ(distributions.mapLabel(1), 1);
}

TEST(LabelDistributions, EntropyFollowsItsFormula)
{
  LabelDistributions distributions(randomWeights(11, 200, 4));
  for (int j = 0; j < 200; ++j) {
    double expected = 0.0;
    for (int k = 0; k < 11; ++k) {
      const double p = distributions.matrix()(k, j);
      expected -= p * std::log(p);
    }
    EXPECT_NEAR(distributions.entropy(j), expected, 1e-5);
  }
  distributions.setLabel(0, 3, 1.0f);
  EXPECT_EQ(distributions.entropy(0), 0.0f);
  distributions.setLabel(0, kUnlabelled, 1.0f);
  EXPECT_NEAR(distributions.entropy(0), std::log(11.0), 1e-6);
}

TEST(FuseLogLikelihood, EqualsTheNormalizedProduct)
{
  constexpr int L = 11;
  constexpr int scans = 20;
  for (unsigned seed = 0; seed < 20; ++seed) {
    // Likelihoods within a factor of e^0.5 of each other: the clamp stays away.
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> log_value(-0.5f, 0.0f);
    std::vector<float> fused(L, 0.0f);
    std::vector<double> product(L, 1.0);
    for (int scan = 0; scan < scans; ++scan) {
      std::vector<float> log_likelihood(L);
      for (int k = 0; k < L; ++k) {
        log_likelihood[k] = log_value(random);
        product[k] *= std::exp(double(log_likelihood[k]));
      }
      fuseLogLikelihood(log_likelihood.data(), L, 20.0f, fused.data());
      EXPECT_EQ(*std::max_element(fused.begin(), fused.end()), 0.0f);
    }
    double sum = 0.0;
    for (const double value : product)
      sum += value;
    std::vector<float> distribution(L);
    distributionFromLog(fused.data(), L, distribution.data());
    for (int k = 0; k < L; ++k)
      EXPECT_NEAR(distribution[k], product[k] / sum, 1e-5);
  }
}

TEST(FuseLogLikelihood, TheClampLetsItChangeItsMind)
{
  const float first[] = {0.9f, 0.05f, 0.05f};
  const float second[] = {0.05f, 0.9f, 0.05f};
  const std::vector<float> log_first = logOf(first, 3);
  const std::vector<float> log_second = logOf(second, 3);
  const float max_log_ratio = 5.0f;
  std::vector<float> fused(3, 0.0f);
  for (int scan = 0; scan < 1000; ++scan)
    fuseLogLikelihood(log_first.data(), 3, max_log_ratio, fused.data());
  EXPECT_FLOAT_EQ(fused[0], 0.0f);
  EXPECT_FLOAT_EQ(fused[1], -max_log_ratio);

  // Each scan turns the ratio by log(0.9 / 0.05) = 2.9: the second one crosses -5.
  fuseLogLikelihood(log_second.data(), 3, max_log_ratio, fused.data());
  EXPECT_GT(fused[0], fused[1]);
  fuseLogLikelihood(log_second.data(), 3, max_log_ratio, fused.data());
  EXPECT_LT(fused[0], fused[1]);
}

TEST(DistributionFromLog, IsTheSoftMaxOfDoublePrecision)
{
  for (float step = 0.0f; step < 100.0f; step += 0.0137f) {
    const float values[4] = {-step, -0.5f * step, 0.0f, -200.0f};
    float found[4];
    distributionFromLog(values, 4, found);
    double sum = 0.0;
    for (const float value : values)
      sum += std::exp(double(value));
    for (int k = 0; k < 4; ++k) {
      const double expected = std::exp(double(values[k])) / sum;
      EXPECT_NEAR(found[k], expected, 1e-6 * expected + 1e-37) << step << " " << k;
    }
  }
}

TEST(DistributionFromLog, DoesNotOverflow)
{
  std::vector<float> values = {1000.0f, 999.0f, -1000.0f};
  distributionFromLog(values.data(), 3, values.data());
  EXPECT_NEAR(values[0], 1.0 / (1.0 + std::exp(-1.0)), 1e-6);
  EXPECT_NEAR(values[1], std::exp(-1.0) / (1.0 + std::exp(-1.0)), 1e-6);
  EXPECT_EQ(values[2], 0.0f);
}
