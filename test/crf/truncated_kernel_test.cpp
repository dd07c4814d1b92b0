// SPDX-License-Identifier: BSD-3-Clause
#include "crf/kernels/truncated_loops.h"
#include "crf/point_rows.h"
#include "crf/truncated_kernel.h"
#include "support/brute_force_crf.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>

namespace {

using namespace pcl_semantic;

std::vector<GaussianTerm>
twoTerms(Eigen::Index count)
{
  return {{3.0f, 0.2f, Eigen::MatrixXf()},
          {8.0f, 0.2f, makeRandomMatrix(3, count, 0.0f, 4.0f, 7)}};
}

Eigen::MatrixXf
product(const TruncatedKernel& kernel, const Eigen::MatrixXf& values)
{
  Eigen::MatrixXf result = Eigen::MatrixXf::Zero(values.rows(), values.cols());
  kernel.addProduct(values, result);
  return result;
}

// For each point the points in the runs of its group, both in the caller's order.
std::vector<std::vector<std::int32_t>>
neighboursOf(const Eigen::Matrix3Xf& positions, float reach, float cell)
{
  const PointRows rows(positions, reach, cell);
  const PointRows::Groups groups = rows.findRuns(0, rows.size());
  std::vector<std::vector<std::int32_t>> all(rows.size());
  for (std::size_t g = 0, i = 0, r = 0; g < groups.run_ends.size(); ++g) {
    std::vector<std::int32_t> list;
    for (; r < groups.run_ends[g]; ++r)
      for (std::uint32_t k = 0; k < (groups.runs[r] & kernels::run_length_mask); ++k)
        list.push_back(rows.order()[(groups.runs[r] >> kernels::run_length_bits) + k]);
    std::sort(list.begin(), list.end());
    for (; i < groups.point_ends[g]; ++i)
      all[std::size_t(rows.order()[i])] = list;
  }
  return all;
}

TEST(PointRows, FindAllPointsWithinTheReach)
{
  for (const float reach : {0.05f, 0.3f, 5.0f}) {
    Eigen::Matrix3Xf positions = makeRandomMatrix(3, 400, -1.0f, 1.0f, 1);
    for (int i = 0; i < 20; ++i) // more points in one place than a run holds
      positions.col(7 + i) = positions.col(7);
    const auto found = neighboursOf(positions, reach, reach / 3.0f);
    for (Eigen::Index i = 0; i < 400; ++i)
      for (Eigen::Index j = 0; j < 400; ++j)
        if ((positions.col(j) - positions.col(i)).norm() <= reach) {
          ASSERT_TRUE(std::binary_search(found[std::size_t(i)].begin(),
                                         found[std::size_t(i)].end(), int(j)))
              << "points " << i << " and " << j << " reach " << reach;
        }
  }
}

TEST(PointRows, FindLittleElseOnAGrid)
{
  const Eigen::Matrix3Xf positions = makeVoxelPositions(500, 3);
  const auto found = neighboursOf(positions, 0.4f, 0.1f);
  for (Eigen::Index i = 0; i < 500; ++i)
    for (const std::int32_t j : found[std::size_t(i)]) {
      // The group reaches up to four cells along x, and nowhere else.
      const Eigen::Array3f d = (positions.col(j) - positions.col(i)).array().abs();
      EXPECT_LE(d.tail<2>().matrix().norm(), 0.4001f);
      EXPECT_LE(d.x(), 0.8001f);
    }
}

TEST(PointRows, RowsFarApartAreFoundToo)
{
  // A row with gaps wider and narrower than those that divide rows.
  Eigen::Matrix3Xf positions = Eigen::Matrix3Xf::Zero(3, 6);
  positions.row(0) << 0.0f, 0.1f, 20.0f, 20.1f, 50.0f, 50.1f;
  const auto found = neighboursOf(positions, 0.4f, 0.1f);
  for (int i = 0; i < 6; ++i)
    EXPECT_EQ(found[std::size_t(i)],
              (std::vector<std::int32_t>{i / 2 * 2, i / 2 * 2 + 1}));
}

TEST(PointRows, NoPointsAndOnePoint)
{
  EXPECT_EQ(PointRows(Eigen::Matrix3Xf(3, 0), 1.0f, 0.5f).size(), 0u);
  EXPECT_EQ(neighboursOf(Eigen::Matrix3Xf::Ones(3, 1), 1.0f, 0.5f)[0].size(), 1u);
}

// Random positive numbers for the inner loops.
std::vector<float>
makeArray(Eigen::Index size, unsigned seed)
{
  const Eigen::MatrixXf values = makeRandomMatrix(1, size, 0.1f, 1.0f, seed);
  return {values.data(), values.data() + size};
}

// The terms as a kernel cut off at a radius widens them.
std::vector<GaussianTerm>
widened(std::vector<GaussianTerm> terms, float radius)
{
  for (GaussianTerm& term : terms)
    term.position_deviation *=
        std::sqrt(TruncatedKernel::widening(radius, Normalization::symmetric));
  return terms;
}

TEST(TruncatedKernel, EqualsTheBruteForceSumWithinTheRadius)
{
  const Eigen::Index count = 600;
  const Eigen::Matrix3Xf positions = makeVoxelPositions(count, 2);
  const auto terms = twoTerms(count);
  const TruncatedKernel kernel(positions, terms, 2.5f);
  const Eigen::MatrixXf values = makeRandomMatrix(5, count, 0.0f, 1.0f, 3);
  const Eigen::MatrixXd expected =
      values.cast<double>() *
      makeKernelMatrix(positions, widened(terms, 2.5f), 0.5 + 1e-5).transpose();
  const Eigen::MatrixXd error = product(kernel, values).cast<double>() - expected;
  // Weights of 8 bits, rounded twice.
  EXPECT_LT((error.array() / expected.array()).abs().maxCoeff(), 1.0 / 128);
  EXPECT_GT(expected.minCoeff(), 0.1);
}

TEST(TruncatedKernel, OtherNormalizations)
{
  const Eigen::Index count = 300;
  const Eigen::Matrix3Xf positions = makeRandomMatrix(3, count, 0.0f, 1.0f, 12);
  const auto terms = twoTerms(count);
  const Eigen::MatrixXf values = makeRandomMatrix(3, count, 0.0f, 1.0f, 13);
  for (const auto normalization : {Normalization::one_sided, Normalization::none}) {
    const TruncatedKernel kernel(positions, terms, 3.5f, normalization);
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(count, count);
    for (const GaussianTerm& term :
         normalization == Normalization::none ? terms : widened(terms, 3.5f)) {
      Eigen::MatrixXd k(count, count);
      for (Eigen::Index i = 0; i < count; ++i)
        for (Eigen::Index j = 0; j < count; ++j) {
          const double distance = double((positions.col(i) - positions.col(j)).norm());
          double exponent = std::pow(distance / double(term.position_deviation), 2);
          if (term.features.size() > 0)
            exponent +=
                double((term.features.col(i) - term.features.col(j)).squaredNorm());
          k(i, j) = distance <= 0.70001 ? std::exp(-0.5 * exponent) : 0.0;
        }
      if (normalization == Normalization::one_sided)
        k = (k.rowwise().sum().cwiseInverse().eval().asDiagonal() * k).eval();
      expected += double(term.weight) * k;
    }
    for (Eigen::Index i = 0; i < count; ++i)
      EXPECT_NEAR(kernel.diagonal(i), expected(i, i), 1e-3 * expected(i, i));
    expected.diagonal().setZero();
    const Eigen::MatrixXd sum = values.cast<double>() * expected.transpose();
    const Eigen::MatrixXd error = product(kernel, values).cast<double>() - sum;
    EXPECT_LT((error.array() / sum.array()).abs().maxCoeff(), 1.0 / 128);
  }
}

TEST(TruncatedKernel, SameBitsInEveryTier)
{
  // Points 20..23 and the runs 3..12, 17..32 and 40.
  constexpr std::size_t stride = 40 + 1 + 16;
  const std::vector<float> arrays = makeArray(8 * stride, 1);
  const float* const left[] = {arrays.data(), arrays.data() + stride};
  const std::uint32_t runs[] = {3 << 5 | 10, 17 << 5 | 16, 40 << 5 | 1};
  const kernels::GroupView group{runs, 3, 27, 20, 4};
  const std::vector<float> values = makeArray(41 * 32, 5);
  for (const int dimensions : {1, 3}) { // three have a loop of their own
    const kernels::TermView terms[] = {{0, 3}, {dimensions, 3}};
    const kernels::PointsView points{
        arrays.data(), stride, 3 + std::size_t(dimensions), 0.6f, 4.0f, terms, 2, left};
    std::vector<float> scratch(kernels::scratchSize(27, 6 + std::size_t(dimensions)));
    std::vector<float> expected_sums, expected;
    for (const SimdTier tier : {SimdTier::plain, SimdTier::avx2, SimdTier::avx512}) {
      if (tier > simdTier())
        continue;
      const kernels::TruncatedLoops& loops = kernels::truncatedLoops(tier);
      std::vector<float> sums(2 * kernels::max_points), results(4 * 32, 0.5f);
      std::vector<std::uint32_t> weights(4 * kernels::strideOf(27) / 2);
      loops.sumTerms(points, group, scratch.data(), sums.data(), weights.data());
      loops.makeWeights(points, group, scratch.data(), weights.data());
      loops.addProduct(group, weights.data(), values.data(), 32, scratch.data(),
                       results.data());
      if (tier == SimdTier::plain) {
        expected_sums = sums;
        expected = results;
      }
      EXPECT_EQ(sums, expected_sums) << nameOf(tier);
      EXPECT_EQ(results, expected) << nameOf(tier);
    }
  }
}

TEST(TruncatedKernel, TiersFindTheSameRuns)
{
  // 40 rows of 1 to 30 cells, every other one occupied, and 16 without cells.
  std::vector<std::uint32_t> starts;
  std::vector<std::int32_t> arrays[4];
  std::uint32_t points = 0;
  for (int r = 0; r < 40; ++r) {
    arrays[0].push_back(int(starts.size()));
    arrays[1].push_back(r % 9);
    arrays[2].push_back(1 + r * 29 / 39);
    arrays[3].push_back(r % 5);
    for (int c = 0; c <= arrays[2].back(); ++c)
      starts.push_back(c % 2 == 0 && c < arrays[2].back() ? points++ : points);
  }
  for (auto& array : arrays)
    array.resize(56, 0);
  const kernels::NearRowsView rows{starts.data(),    arrays[0].data(), arrays[1].data(),
                                   arrays[2].data(), arrays[3].data(), 40};
  std::vector<std::uint32_t> expected(56), found(56);
  for (int cell = -3; cell < 40; ++cell) {
    const std::size_t count = kernels::truncatedLoops(SimdTier::plain)
                                  .findRuns(rows, cell, cell + 2, expected.data());
    for (const SimdTier tier : {SimdTier::avx2, SimdTier::avx512})
      if (tier <= simdTier()) {
        ASSERT_EQ(
            kernels::truncatedLoops(tier).findRuns(rows, cell, cell + 2, found.data()),
            count);
        EXPECT_TRUE(
            std::equal(found.begin(), found.begin() + long(count), expected.begin()));
      }
  }
  EXPECT_GT(points, 300u);
}

// A pair whose distance is computed as exactly the radius has to stay.
TEST(TruncatedKernel, RunsAreTrimmedToPointsNearTheBoxOfTheirGroup)
{
  constexpr std::size_t count = 200, stride = count + 16;
  std::vector<float> arrays = makeArray(3 * stride, 1);
  const auto at = [&](std::size_t i) {
    return Eigen::Vector3f(arrays[i], arrays[stride + i], arrays[2 * stride + i]);
  };
  for (std::size_t i = 104; i < count; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      arrays[axis * stride + i] *= 3.0f;
  const Eigen::AlignedBox3f box = Eigen::AlignedBox3f(at(100)).extend(at(101));
  const float squared_radius = box.squaredExteriorDistance(at(150));
  const kernels::PointsView points{arrays.data(), stride,  3, squared_radius,
                                   4.0f,          nullptr, 0, nullptr};
  std::vector<std::uint32_t> runs, expected;
  for (std::uint32_t first = 0, length = 1; first + length <= count;
       first += length, length = length % 16 + 1) {
    runs.push_back(first << kernels::run_length_bits | length);
    std::uint32_t begin = count, end = 0;
    for (std::uint32_t i = first; i < first + length; ++i)
      if (box.squaredExteriorDistance(at(i)) <= squared_radius) {
        begin = std::min(begin, i);
        end = i + 1;
      }
    if (end > 0)
      expected.push_back(begin << kernels::run_length_bits | (end - begin));
  }
  ASSERT_LT(expected.size(), runs.size());
  for (const SimdTier tier : {SimdTier::plain, SimdTier::avx2, SimdTier::avx512}) {
    std::vector<std::uint32_t> trimmed = runs;
    const kernels::GroupView group{trimmed.data(), runs.size(), count, 100, 2};
    if (tier <= simdTier()) {
      trimmed.resize(
          kernels::truncatedLoops(tier).trimRuns(points, group, trimmed.data()));
      EXPECT_EQ(trimmed, expected) << nameOf(tier);
    }
  }
}

TEST(TruncatedKernel, TheStatedRadiusKeepsTheMassOfASurface)
{
  // A flat surface of 41 x 41 voxels: the voxel in its middle sees no border.
  Eigen::Matrix3Xf positions(3, 41 * 41);
  for (int y = 0; y < 41; ++y)
    for (int x = 0; x < 41; ++x)
      positions.col(y * 41 + x) << 0.1f * float(x), 0.1f * float(y), 0.0f;
  const std::vector<GaussianTerm> terms{{1.0f, 0.2f, Eigen::MatrixXf()}};
  const Eigen::MatrixXd exact = makeKernelMatrix(positions, terms, 1.0);
  const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(1, positions.cols());
  const double full = (ones * exact)(20 * 41 + 20);
  const TruncatedKernel kernel(positions, terms, 2.5f);
  const double kept =
      product(kernel, Eigen::MatrixXf::Ones(1, positions.cols()))(20 * 41 + 20);
  // Normalisation returns most of the truncated weight to the remaining pairs.
  EXPECT_NEAR(kept / full, 1.0, 0.01);
}

// A surface with a bend, of points a spacing apart.
Eigen::Matrix3Xf
makeSurface(float spacing)
{
  Eigen::Matrix3Xf positions(3, 30 * 30);
  for (int i = 0; i < 30 * 30; ++i)
    positions.col(i) << spacing * float(i % 30), spacing * float(std::min(i / 30, 15)),
        spacing * float(std::max(i / 30 - 15, 0));
  return positions;
}

TEST(TruncatedKernel, AShortRadiusIsNearTheWholeGaussian)
{
  // Its product with waves, and that of all pairs of the kernel as eq. (6) has it.
  const Eigen::Matrix3Xf positions = makeSurface(0.1f);
  const std::vector<GaussianTerm> terms{{1.0f, 0.2f, Eigen::MatrixXf()}};
  Eigen::MatrixXf values(2, positions.cols());
  values.row(0) = (positions.row(0).array() * float(2.0 * M_PI / 0.8)).cos() + 1.0f;
  values.row(1) =
      (positions.bottomRows(2).colwise().sum().array() * float(2.0 * M_PI / 0.8))
          .sin() +
      1.0f;
  const Eigen::MatrixXd expected =
      values.cast<double>() * makeKernelMatrix(positions, terms).transpose();
  for (const auto& [radius, most] : {std::pair(2.0f, 0.025), {3.0f, 0.003}}) {
    const TruncatedKernel kernel(positions, terms, radius);
    const Eigen::MatrixXd error = product(kernel, values).cast<double>() - expected;
    // A variance that is not made larger gives 0.06 at radius 2, three times it 0.03.
    EXPECT_LT(error.norm(), most * expected.norm()) << "radius " << radius;
  }
}

TEST(TruncatedKernel, WithoutNormalizationNothingIsMadeUpFor)
{
  const Eigen::Matrix3Xf positions = makeSurface(0.1f);
  const std::vector<GaussianTerm> terms{{1.0f, 0.2f, Eigen::MatrixXf()}};
  for (const auto& [radius, tolerance] :
       {std::pair(2.0f, 1.0 / 128), {3.0f, 1.0 / 128}}) {
    const TruncatedKernel kernel(positions, terms, radius, Normalization::none);
    const Eigen::MatrixXf sums = product(kernel, Eigen::MatrixXf::Ones(1, 900));
    for (Eigen::Index i = 0; i < 900; ++i) {
      double sum = 0.0;
      for (Eigen::Index j = 0; j < 900; ++j) {
        const double squared =
            (positions.col(i) - positions.col(j)).cast<double>().squaredNorm() / 0.04;
        if (j != i && squared <= double(radius * radius) + 1e-4)
          sum += std::exp(-0.5 * squared);
      }
      EXPECT_NEAR(sums(i), sum, tolerance * sum);
    }
  }
}

TEST(TruncatedKernel, TheOrderOfPointsChangesNoBit)
{
  const Eigen::Index count = 1500; // several in a cell
  const Eigen::Matrix3Xf positions = makeRandomMatrix(3, count, 0.0f, 1.0f, 33);
  const auto terms = twoTerms(count);
  const Eigen::MatrixXf values = makeRandomMatrix(5, count, 0.0f, 1.0f, 34);
  std::vector<int> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::minstd_rand(35));
  std::vector<GaussianTerm> shuffled = terms;
  shuffled[1].features = terms[1].features(Eigen::all, order).eval();
  const Eigen::MatrixXf expected =
      product(TruncatedKernel(positions, terms, 2.0f), values)(Eigen::all, order);
  EXPECT_EQ(product(TruncatedKernel(positions(Eigen::all, order), shuffled, 2.0f),
                    values(Eigen::all, order)),
            expected);
}

TEST(TruncatedKernel, SameBitsForAnyNumberOfThreads)
{
  const Eigen::Index count = 3000;
  const Eigen::Matrix3Xf positions = makeVoxelPositions(count, 4);
  const Eigen::MatrixXf values = makeRandomMatrix(11, count, 0.0f, 1.0f, 5);
  std::vector<Eigen::MatrixXf> results;
  for (const int threads : {1, 2, 7}) {
    setNumberOfThreads(threads);
    results.push_back(
        product(TruncatedKernel(positions, twoTerms(count), 2.5f), values));
  }
  setNumberOfThreads(0);
  EXPECT_TRUE(results[0] == results[1]);
  EXPECT_TRUE(results[0] == results[2]);
}

TEST(TruncatedKernel, RefusesWhatCannotWork)
{
  Eigen::Matrix3Xf positions = makeVoxelPositions(10, 6);
  const auto refused = [&](const std::vector<GaussianTerm>& terms, float radius) {
    EXPECT_THROW(TruncatedKernel(positions, terms, radius), InvalidParameterException);
  };
  refused({{1.0f, 0.0f, {}}}, 2.5f);
  refused({{1.0f, std::nanf(""), {}}}, 2.5f);
  refused({{-1.0f, 0.2f, {}}}, 2.5f);
  refused({{1.0f, 0.2f, Eigen::MatrixXf::Zero(3, 9)}}, 2.5f);
  refused({{1.0f, 0.2f, Eigen::MatrixXf::Constant(3, 10, INFINITY)}}, 2.5f);
  refused({{1.0f, 0.2f, {}}}, 0.0f);
  positions(0, 0) = std::nanf("");
  refused({{1.0f, 0.2f, {}}}, 2.5f);
  positions(0, 0) = 1e30f;
  refused({{1.0f, 0.2f, {}}}, 2.5f);
}

} // namespace
