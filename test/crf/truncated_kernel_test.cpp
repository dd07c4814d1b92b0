/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "crf/kernels/run_search.h"
#include "crf/point_rows.h"
#include "support/brute_force_crf.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/crf/truncated_kernel.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace {

using namespace pcl_semantic;

std::vector<GaussianTerm>
twoTerms(Eigen::Index count)
{
  return {{3.0f, 0.2f, Eigen::MatrixXf()},
          {8.0f, 0.15f, makeRandomMatrix(3, count, 0.0f, 4.0f, 7)}};
}

Eigen::MatrixXf
product(const TruncatedKernel& kernel, const Eigen::MatrixXf& values)
{
  Eigen::MatrixXf result = Eigen::MatrixXf::Zero(values.rows(), values.cols());
  kernel.addProduct(values, result, {});
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

// The terms as a kernel cut off at a radius widens them.
std::vector<GaussianTerm>
widened(std::vector<GaussianTerm> terms, float radius)
{
  for (GaussianTerm& term : terms)
    term.position_deviation *= std::sqrt(TruncatedKernel::widening(radius));
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
  // Normalisation gives most of what is cut off back to the pairs that stay.
  EXPECT_NEAR(kept / full, 1.0, 0.01);
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
