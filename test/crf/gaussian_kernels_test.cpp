// SPDX-License-Identifier: BSD-3-Clause
#include "crf/lattice_kernel.h"
#include "crf/truncated_kernel.h"
#include "support/brute_force_crf.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/gaussian_kernels.h>

#include <gtest/gtest.h>

#include <numeric>

namespace {

using namespace pcl_semantic;

// Pixels of an image, row by row.
Eigen::MatrixXf
makePixels(int width, int height)
{
  Eigen::MatrixXf positions(2, width * height);
  for (int i = 0; i < width * height; ++i)
    positions.col(i) << float(i % width), float(i / width);
  return positions;
}

TEST(GaussianKernels, ChoosesByTheNumberOfNeighbours)
{
  const Eigen::MatrixXf voxels = makeVoxelPositions(2000, 1);
  const GaussianKernels near(voxels, {0.2f, 0.2f});
  EXPECT_EQ(near.method(0), KernelMethod::truncated);
  EXPECT_EQ(near.method(1), KernelMethod::truncated);
  // 3 px reach 113 pixels, 40 px some 20,000.
  const GaussianKernels image(makePixels(300, 200), {3.0f, 40.0f});
  EXPECT_EQ(image.method(0), KernelMethod::truncated);
  EXPECT_EQ(image.method(1), KernelMethod::lattice);
}

TEST(GaussianKernels, TakesLatticesForPointsTooFarApartForRows)
{
  Eigen::MatrixXf positions = makeVoxelPositions(100, 1);
  positions(0, 99) = 150000.0f; // 750,000 deviations
  EXPECT_EQ(GaussianKernels(positions, {0.2f}).method(0), KernelMethod::lattice);
  GaussianKernelOptions options;
  options.method = KernelMethod::truncated;
  expectBadParameter(
      "apart, expected at most 104858 for truncated kernels: take lattices",
      [&] { GaussianKernels kernels(positions, {0.2f}, options); });
}

TEST(GaussianKernels, AMethodCanBeAskedFor)
{
  const Eigen::MatrixXf voxels = makeVoxelPositions(200, 1);
  for (const KernelMethod method : {KernelMethod::truncated, KernelMethod::lattice}) {
    GaussianKernelOptions options;
    options.method = method;
    const GaussianKernels kernels(voxels, {0.2f, 5.0f}, options);
    EXPECT_EQ(kernels.method(0), method);
    EXPECT_EQ(kernels.method(1), method);
    EXPECT_EQ(kernels.fastestOrder().empty(), method == KernelMethod::lattice);
  }
}

TEST(GaussianKernels, CountsNeighboursOfFewPointsExactlyAndOfManyNearly)
{
  const Eigen::Matrix3Xf few = makeVoxelPositions(60, 2);
  double found = 0.0;
  for (Eigen::Index i = 0; i < 60; ++i)
    for (Eigen::Index j = 0; j < 60; ++j)
      found += (few.col(i) - few.col(j)).squaredNorm() <= 0.25f;
  EXPECT_DOUBLE_EQ(GaussianKernels::meanNeighbours(few, 0.5f), found / 60.0);
  // 197 pixels lie within 8 px; a few less at the border of 500 x 400.
  Eigen::Matrix3Xf pixels = Eigen::Matrix3Xf::Zero(3, 500 * 400);
  pixels.topRows(2) = makePixels(500, 400);
  EXPECT_NEAR(GaussianKernels::meanNeighbours(pixels, 8.0f), 193.0, 40.0);
  EXPECT_EQ(GaussianKernels::meanNeighbours(Eigen::Matrix3Xf(3, 0), 1.0f), 0.0);
}

TEST(GaussianKernels, TheFastestOrderIsOneOfAllPointsAndStays)
{
  const Eigen::MatrixXf voxels = makeVoxelPositions(500, 3);
  const GaussianKernels kernels(voxels, {0.2f});
  std::vector<std::int32_t> order = kernels.fastestOrder();
  EXPECT_EQ(order, TruncatedKernel::fastestOrder(voxels, 2.0f, 0.2f));
  Eigen::MatrixXf sorted(3, 500);
  for (Eigen::Index k = 0; k < 500; ++k)
    sorted.col(k) = voxels.col(order[std::size_t(k)]);
  std::vector<std::int32_t> numbers(500);
  std::iota(numbers.begin(), numbers.end(), 0);
  EXPECT_EQ(GaussianKernels(sorted, {0.2f}).fastestOrder(), numbers);
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, numbers);
}

// Every term alone and both together are the kernels of their classes.
TEST(GaussianKernels, MakesTheKernelsOfTheTerms)
{
  const Eigen::MatrixXf pixels = makePixels(20, 15);
  const Eigen::MatrixXf grey = makeRandomMatrix(1, 300, 0.0f, 3.0f, 4);
  const std::vector<GaussianTerm> terms = {{2.0f, 1.5f, Eigen::MatrixXf()},
                                           {0.0f, 1.5f, Eigen::MatrixXf()},
                                           {3.0f, 12.0f, grey}};
  GaussianKernelOptions options;
  options.normalization = Normalization::one_sided;
  const Eigen::MatrixXf values = makeRandomMatrix(3, 300, 0.0f, 1.0f, 5);
  const auto product = [&](const GaussianKernels::List& kernels) {
    Eigen::MatrixXf sum = Eigen::MatrixXf::Zero(3, 300);
    for (const auto& kernel : kernels)
      kernel->addProduct(values, sum);
    return sum;
  };
  Eigen::Matrix3Xf padded = Eigen::Matrix3Xf::Zero(3, 300);
  padded.topRows(2) = pixels;
  Eigen::MatrixXf features(3, 300);
  features << pixels / 12.0f, grey;
  for (const KernelMethod method : {KernelMethod::truncated, KernelMethod::lattice}) {
    options.method = method;
    const auto kernels =
        GaussianKernels(pixels, {1.5f, 1.5f, 12.0f}, options).make(pixels, terms);
    Eigen::MatrixXf expected;
    if (method == KernelMethod::truncated) {
      ASSERT_EQ(kernels.size(), 2u); // weight 0 is left out
      expected = product({std::make_shared<TruncatedKernel>(
                              padded, std::vector<GaussianTerm>{terms[0]}, 2.0f,
                              Normalization::one_sided),
                          std::make_shared<TruncatedKernel>(
                              padded, std::vector<GaussianTerm>{terms[2]}, 2.0f,
                              Normalization::one_sided)});
    }
    else {
      ASSERT_EQ(kernels.size(), 2u);
      expected = product(
          {std::make_shared<LatticeKernel>(pixels / 1.5f, 2.0f,
                                           Normalization::one_sided),
           std::make_shared<LatticeKernel>(features, 3.0f, Normalization::one_sided)});
    }
    EXPECT_EQ(product(kernels), expected);
  }
}

// Those of one deviation share their pairs.
TEST(GaussianKernels, TermsOfOneDeviationAreOneTruncatedKernel)
{
  const Eigen::MatrixXf voxels = makeVoxelPositions(100, 9);
  const std::vector<GaussianTerm> terms = {
      {1.0f, 0.2f, Eigen::MatrixXf()},
      {2.0f, 0.2f, makeRandomMatrix(3, 100, 0.0f, 1.0f, 10)}};
  EXPECT_EQ(GaussianKernels(voxels, {0.2f, 0.2f}).make(voxels, terms).size(), 1u);
}

TEST(GaussianKernels, BothMethodsComeNearToTheExactSum)
{
  const Eigen::Matrix3Xf voxels = makeVoxelPositions(600, 6);
  const std::vector<GaussianTerm> terms = {{1.0f, 0.2f, Eigen::MatrixXf()}};
  const Eigen::MatrixXf values = makeRandomMatrix(2, 600, 0.0f, 1.0f, 7);
  const Eigen::MatrixXd exact =
      values.cast<double>() * makeKernelMatrix(voxels, terms, 1.0);
  for (const KernelMethod method : {KernelMethod::truncated, KernelMethod::lattice}) {
    GaussianKernelOptions options;
    options.method = method;
    Eigen::MatrixXf result = Eigen::MatrixXf::Zero(2, 600);
    for (const auto& kernel :
         GaussianKernels(voxels, {0.2f}, options).make(voxels, terms))
      kernel->addProduct(values, result);
    const Eigen::MatrixXd error = result.cast<double>() - exact;
    EXPECT_LT(error.norm() / exact.norm(), 0.1) << int(method);
  }
}

TEST(GaussianKernels, RefusesWhatCannotBe)
{
  const Eigen::MatrixXf points = makeVoxelPositions(10, 8);
  EXPECT_THROW(GaussianKernels(Eigen::MatrixXf(4, 10), {1.0f}),
               InvalidParameterException);
  EXPECT_THROW(GaussianKernels(Eigen::MatrixXf(0, 10), {1.0f}),
               InvalidParameterException);
  EXPECT_THROW(GaussianKernels(points, {0.0f}), InvalidParameterException);
  EXPECT_THROW(GaussianKernels(points, {1.0f, std::nanf("")}),
               InvalidParameterException);
  Eigen::MatrixXf broken = points;
  broken(1, 4) = std::nanf("");
  EXPECT_THROW(GaussianKernels(broken, {1.0f}), InvalidParameterException);
  GaussianKernelOptions options;
  options.radius = 0.0f;
  EXPECT_THROW(GaussianKernels(points, {1.0f}, options), InvalidParameterException);
  EXPECT_THROW(GaussianKernels(points, {1.0f}).make(points, {}),
               InvalidParameterException);
}

} // namespace
