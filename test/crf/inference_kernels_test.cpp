// SPDX-License-Identifier: BSD-3-Clause

// The hot loops of inference, every tier against plain sums in double precision.

#include "../../src/crf/kernels/inference_loops.h"
#include "../../src/crf/padded_columns.h"
#include "support/brute_force_crf.h"
#include "support/supported_tiers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace {

using namespace pcl_semantic;

PaddedColumns
padded(const Eigen::MatrixXf& matrix, float padding = 0.0f)
{
  PaddedColumns columns(matrix.rows(), matrix.cols());
  for (Eigen::Index i = 0; i < matrix.cols(); ++i)
    columns.setColumn(i, matrix.data() + i * matrix.rows(), padding);
  return columns;
}

// Lists of 0 to 3 indices, and one of 100.
struct Lists {
  std::vector<std::size_t> starts{0};
  std::vector<std::int32_t> indices;

  Lists(std::size_t rows, unsigned columns)
  {
    std::mt19937 random(7);
    for (std::size_t r = 0; r < rows; ++r) {
      const unsigned count = r == 3 ? 100 : unsigned(random() % 4);
      for (unsigned e = 0; e < count; ++e)
        indices.push_back(std::int32_t(random() % columns));
      starts.push_back(indices.size());
    }
  }
};

struct Case {
  SimdTier tier;
  Eigen::Index rows;
};

std::vector<Case>
allCases()
{
  std::vector<Case> cases;
  for (const SimdTier tier : supportedTiers())
    for (const Eigen::Index rows : {1, 5, 8, 9, 16, 19, 48, 255, 256})
      cases.push_back({tier, rows});
  return cases;
}

class InferenceKernels : public ::testing::TestWithParam<Case> {};

TEST_P(InferenceKernels, SoftMax)
{
  const auto [tier, rows] = GetParam();
  const Eigen::Index count = 200;
  // In steps of 1/64, whose differences have no rounding that exp() would magnify.
  const auto steps = [](const Eigen::MatrixXf& values) {
    return Eigen::MatrixXf((values.array() * 64.0f).floor() / 64.0f);
  };
  const Eigen::MatrixXf costs = steps(makeRandomMatrix(rows, count, 0.0f, 30.0f, 1));
  const Eigen::MatrixXf heard = steps(makeRandomMatrix(rows, count, -60.0f, 60.0f, 2));
  const PaddedColumns padded_costs = padded(costs, kernels::padding_cost);
  PaddedColumns messages = padded(heard);
  PaddedColumns marginals = padded(makeRandomMatrix(rows, count, 0.0f, 1.0f, 3));
  kernels::inferenceLoops(tier).softMax(padded_costs.column(0), messages.column(0),
                                        marginals.column(0), std::size_t(count),
                                        std::size_t(marginals.stride()));
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::VectorXd exponents = (heard.col(i) - costs.col(i)).cast<double>();
    const Eigen::VectorXd below = exponents.array() - exponents.maxCoeff();
    const double sum = below.array().exp().sum();
    for (Eigen::Index l = 0; l < rows; ++l) {
      const double expected = std::exp(below(l)) / sum;
      const double q = double(marginals.column(i)[l]);
      if (below(l) > -54.9) {
        ASSERT_NEAR(q, expected, 1e-6 * expected);
      }
      else if (below(l) < -55.1) {
        ASSERT_EQ(q, 0.0);
      }
    }
    for (Eigen::Index l = 0; l < marginals.stride(); ++l) {
      ASSERT_EQ(messages.column(i)[l], 0.0f);
      if (l >= rows) {
        ASSERT_EQ(marginals.column(i)[l], 0.0f);
      }
    }
  }
}

TEST_P(InferenceKernels, SumsOfColumns)
{
  const auto [tier, rows] = GetParam();
  const Eigen::MatrixXf values = makeRandomMatrix(rows, 90, 0.0f, 1.0f, 4);
  const Eigen::MatrixXf before = makeRandomMatrix(rows, 60, 0.0f, 1.0f, 5);
  const PaddedColumns columns = padded(values);
  const auto stride = std::size_t(columns.stride());
  PaddedColumns result = padded(before);
  const Lists lists(60, 90);
  const kernels::InferenceLoops& loops = kernels::inferenceLoops(tier);
  loops.addColumns(lists.starts.data(), lists.indices.data(), 60, columns.column(0),
                   stride, result.column(0));
  for (std::size_t r = 0; r < 60; ++r) {
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(rows);
    for (std::size_t e = lists.starts[r]; e < lists.starts[r + 1]; ++e)
      expected += values.col(lists.indices[e]).cast<double>();
    std::vector<double> sum(stride, -1.0);
    loops.sumColumns(
        lists.indices.data() + lists.starts[r], lists.starts[r + 1] - lists.starts[r],
        lists.indices.size() - lists.starts[r], columns.column(0), stride, sum.data());
    for (Eigen::Index l = 0; l < Eigen::Index(stride); ++l) {
      const double both =
          l < rows ? expected(l) + double(before(l, Eigen::Index(r))) : 0.0;
      ASSERT_NEAR(sum[std::size_t(l)], l < rows ? expected(l) : 0.0, 1e-12);
      ASSERT_NEAR(double(result.column(Eigen::Index(r))[l]), both,
                  1e-6 * (1.0 + both)); // of 100 summands at most
    }
  }
}

TEST_P(InferenceKernels, ProductsWithoutOneFactor)
{
  const auto [tier, rows] = GetParam();
  Eigen::MatrixXf values = makeRandomMatrix(rows, 30, 0.2f, 1.0f, 6);
  std::mt19937 random(8);
  for (int zero = 0; zero < 4 * rows; ++zero)
    values(Eigen::Index(random() % std::uint64_t(rows)), random() % 30) = 0.0f;
  values(0, 3) = 1e-26f;
  const PaddedColumns columns = padded(values);
  const auto stride = std::size_t(columns.stride());
  const kernels::InferenceLoops& loops = kernels::inferenceLoops(tier);
  // Products over 0..9, 5..14, ... , each in one list of every factor in it.
  std::vector<double> kept(4 * stride);
  std::vector<std::int32_t> indices(30);
  std::iota(indices.begin(), indices.end(), 0);
  Lists lists(0, 1);
  for (int i = 0; i < 30; ++i) {
    for (int p = 0; p < 4; ++p)
      if (i >= 5 * p && i < 5 * p + 10)
        lists.indices.push_back(p);
    lists.starts.push_back(lists.indices.size());
  }
  for (std::size_t p = 0; p < 4; ++p)
    loops.multiplyColumns(indices.data() + 5 * p, 10, indices.size() - 5 * p,
                          columns.column(0), stride, &kept[p * stride]);
  PaddedColumns result = padded(Eigen::MatrixXf::Ones(rows, 30));
  loops.addWithout(lists.starts.data(), lists.indices.data(), 30, kept.data(),
                   columns.column(0), stride, result.column(0));
  int alone = 0; // zeros whose product without them is none
  for (int i = 0; i < 30; ++i)
    for (Eigen::Index l = 0; l < rows; ++l) {
      double expected = 1.0;
      for (int p = 0; p < 4; ++p)
        if (i >= 5 * p && i < 5 * p + 10) {
          double product = 1.0;
          for (int j = 5 * p; j < 5 * p + 10; ++j)
            if (j != i)
              product *= double(values(l, j));
          expected += product;
          alone += product > 0.0 && values(l, i) == 0.0f ? 1 : 0;
        }
      ASSERT_NEAR(double(result.column(i)[l]), expected, 1e-6) << i << " " << l;
    }
  EXPECT_GT(alone, 0);
}

TEST_P(InferenceKernels, ProductsOfManyFactors)
{
  const auto [tier, rows] = GetParam();
  const PaddedColumns columns = padded(Eigen::MatrixXf::Constant(rows, 1, 0.9f));
  const kernels::InferenceLoops& loops = kernels::inferenceLoops(tier);
  std::vector<double> product(std::size_t(columns.stride()));
  const std::vector<std::int32_t> indices(10000, 0);
  for (const int count : {0, 1, 100, 1000, 10000}) {
    loops.multiplyColumns(indices.data(), std::size_t(count), indices.size(),
                          columns.column(0), product.size(), product.data());
    const double expected = std::pow(double(0.9f), count);
    ASSERT_NEAR(product[0], expected > 1e-200 ? expected : 0.0, 1e-11 * expected);
  }
}

TEST_P(InferenceKernels, MixedLabels)
{
  const auto [tier, rows] = GetParam();
  const Eigen::MatrixXf matrix = makeRandomMatrix(rows, rows, -1.0f, 1.0f, 9);
  const Eigen::MatrixXf heard = makeRandomMatrix(rows, 20, -1.0f, 1.0f, 10);
  PaddedColumns columns = padded(heard);
  const PaddedColumns costs = padded(matrix);
  kernels::inferenceLoops(tier).mixLabels(costs.column(0), std::size_t(rows),
                                          columns.column(0), 20,
                                          std::size_t(columns.stride()));
  const Eigen::MatrixXd expected = -matrix.cast<double>() * heard.cast<double>();
  EXPECT_LT((columns.matrix().cast<double>() - expected).cwiseAbs().maxCoeff(), 2e-5);
  EXPECT_TRUE((columns.view().bottomRows(columns.stride() - rows).array() == 0).all());
}

std::string
nameOfCase(const ::testing::TestParamInfo<Case>& info)
{
  return std::string(nameOf(info.param.tier)) + "_" + std::to_string(info.param.rows);
}

INSTANTIATE_TEST_SUITE_P(Tiers, InferenceKernels, ::testing::ValuesIn(allCases()),
                         nameOfCase);

// The exponential alone: two labels whose exponents differ by a.
TEST(SoftMax, ExponentialIsRightToOneMillionth)
{
  for (const SimdTier tier : supportedTiers()) {
    double worst = 0.0;
    for (float a = 0.0f; a < 54.9f; a += 0.0007f) {
      alignas(64) float costs[8], messages[8] = {}, marginals[8] = {};
      std::fill_n(costs, 8, kernels::padding_cost);
      costs[0] = 0.0f;
      costs[5] = a;
      kernels::inferenceLoops(tier).softMax(costs, messages, marginals, 1, 8);
      worst = std::max(worst, std::abs(double(marginals[5]) / double(marginals[0]) *
                                           std::exp(double(a)) -
                                       1.0));
    }
    EXPECT_LT(worst, 1e-6) << nameOf(tier);
    EXPECT_GT(worst, 0.0);
  }
}

} // namespace
