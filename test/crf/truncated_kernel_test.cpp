/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "support/brute_force_crf.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/crf/neighbour_search.h>
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

TEST(NeighbourSearch, FindsExactlyThePairsWithinTheRadius)
{
  for (const float radius : {0.05f, 0.3f, 5.0f}) {
    Eigen::Matrix3Xf positions = makeRandomMatrix(3, 400, -1.0f, 1.0f, 1);
    positions.col(7) = positions.col(8); // two points in one place
    const NeighbourLists lists = findNeighbours(positions, radius);
    ASSERT_EQ(lists.starts.size(), 401u);
    for (Eigen::Index i = 0; i < 400; ++i) {
      std::vector<std::int32_t> found(lists.neighbours.begin() + long(lists.starts[i]),
                                      lists.neighbours.begin() +
                                          long(lists.starts[i + 1]));
      std::sort(found.begin(), found.end());
      std::vector<std::int32_t> expected;
      for (Eigen::Index j = 0; j < 400; ++j)
        if (j != i &&
            (positions.col(j) - positions.col(i)).squaredNorm() <= radius * radius)
          expected.push_back(std::int32_t(j));
      ASSERT_EQ(found, expected) << "point " << i << " radius " << radius;
    }
  }
}

TEST(NeighbourSearch, NoPointsAndOnePoint)
{
  EXPECT_EQ(findNeighbours(Eigen::Matrix3Xf(3, 0), 1.0f).starts.size(), 1u);
  EXPECT_TRUE(findNeighbours(Eigen::Matrix3Xf::Ones(3, 1), 1.0f).neighbours.empty());
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
      makeKernelMatrix(positions, terms, 0.5 + 1e-5).transpose();
  const Eigen::MatrixXd error = product(kernel, values).cast<double>() - expected;
  EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-4);
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
