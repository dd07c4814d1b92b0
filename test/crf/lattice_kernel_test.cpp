// SPDX-License-Identifier: BSD-3-Clause
#include "crf/lattice_kernel.h"
#include "support/brute_force_crf.h"
#include "support/plain_lattice.h"
#include "support/supported_tiers.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <thread>

namespace {

// Normally distributed features (d x N).
Eigen::MatrixXf
makeNormalCloud(Eigen::Index dimensions, Eigen::Index count, float deviation,
                unsigned seed)
{
  std::mt19937 random(seed);
  std::normal_distribution<float> value(0.0f, deviation);
  return Eigen::MatrixXf::NullaryExpr(dimensions, count, [&] { return value(random); });
}

// Points in a few distant clusters.
Eigen::MatrixXf
makeClusters(Eigen::Index dimensions, Eigen::Index count, unsigned seed)
{
  const Eigen::MatrixXf centres = makeNormalCloud(dimensions, 5, 8.0f, seed);
  Eigen::MatrixXf features = makeNormalCloud(dimensions, count, 0.5f, seed + 1);
  for (Eigen::Index i = 0; i < count; ++i)
    features.col(i) += centres.col(i % 5);
  return features;
}

// Voxels of half a deviation on a curved surface (first three features). The others are
// integers divided by four, similar to colours.
Eigen::MatrixXf
makeVoxelSurface(Eigen::Index dimensions, Eigen::Index count, unsigned seed)
{
  std::mt19937 random(seed);
  const auto edge = unsigned(std::sqrt(double(count)));
  Eigen::MatrixXf features(dimensions, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index k = 0; k < dimensions; ++k) {
      const unsigned x = unsigned(i) % edge, y = unsigned(i) / edge;
      const unsigned z = x * x / (4 * edge);
      const unsigned voxel = k == 0 ? x : k == 1 ? y : z;
      features(k, i) = k < 3 ? 0.5f * float(voxel)
                             : 0.25f * float(x / 8 + unsigned(k) + random() % 4);
    }
  return features;
}

// The Gaussian exp(-|f_i - f_j|^2 / 2) of all pairs, in double precision.
Eigen::MatrixXd
makeGaussianMatrix(const Eigen::MatrixXf& features)
{
  const Eigen::MatrixXd exact = features.cast<double>();
  Eigen::MatrixXd matrix(exact.cols(), exact.cols());
  for (Eigen::Index j = 0; j < exact.cols(); ++j)
    matrix.col(j) =
        (-0.5 * (exact.colwise() - exact.col(j)).colwise().squaredNorm().array())
            .exp()
            .transpose();
  return matrix;
}

using namespace pcl_semantic;

constexpr float weight = 3.0f;

Eigen::MatrixXf
product(const LatticeKernel& kernel, const Eigen::MatrixXf& values)
{
  Eigen::MatrixXf result = Eigen::MatrixXf::Zero(values.rows(), values.cols());
  kernel.addProduct(values, result);
  return result;
}

Eigen::VectorXf
diagonalOf(const LatticeKernel& kernel)
{
  return Eigen::VectorXf::NullaryExpr(
      kernel.size(), [&](Eigen::Index i) { return kernel.diagonal(i); });
}

// Values filtered by the lattice, j = i included.
Eigen::MatrixXf
filtered(const LatticeKernel& kernel, const Eigen::MatrixXf& values)
{
  const Eigen::MatrixXf own = values * diagonalOf(kernel).asDiagonal();
  return (product(kernel, values) + own) / kernel.lattice().gain();
}

LatticeKernel
latticeAround(const Eigen::MatrixXf& features)
{
  return LatticeKernel(features, 1.0f, Normalization::none);
}

// The plain lattice around points at the places where the fast one has them.
PlainLattice
plainLatticeLike(const PermutohedralLattice& lattice, const Eigen::MatrixXf& features)
{
  const Eigen::Map<const Eigen::VectorXd> origin(lattice.frame.low, features.rows());
  return PlainLattice(features.colwise() - origin.cast<float>());
}

// Four rows filtered by the plain lattice, without its constant factor.
Eigen::MatrixXf
plainlyFiltered(PlainLattice& lattice, const Eigen::MatrixXf& values, bool reversed)
{
  const Eigen::ArrayXf ones = Eigen::ArrayXf::Ones(values.cols());
  PlainLattice::Blocks result(4, values.cols());
  lattice.filter(values.array(), 1, ones, ones, result, reversed);
  return result / lattice.gain();
}

struct Cloud {
  const char* name;
  Eigen::MatrixXf features;
};

std::vector<Cloud>
cloudsOf(Eigen::Index dimensions, Eigen::Index count)
{
  Eigen::MatrixXf pairs = makeNormalCloud(dimensions, count, 2.0f, 3);
  for (Eigen::Index i = 1; i < count; i += 2)
    pairs.col(i) = pairs.col(i - 1);
  return {{"dense", makeNormalCloud(dimensions, count, 0.7f, 1)},
          {"sparse", makeNormalCloud(dimensions, count, 4.0f, 2)},
          {"in pairs", pairs},
          {"clusters", makeClusters(dimensions, count, 4)},
          {"voxels", makeVoxelSurface(dimensions, count, 5)}};
}

TEST(PermutohedralLattice, EqualsThePlainOne)
{
  for (const Eigen::Index d : {1, 2, 3, 4, 5, 6, 7, 8, 11, 16}) {
    // Enough for several chunks. With more corners in sparser clouds, rounding would
    // put some points on the border of simplices.
    const Eigen::Index count = d < 9 ? 3000 : 800;
    for (const Cloud& cloud : cloudsOf(d, count)) {
      SCOPED_TRACE(std::string(cloud.name) + ", d " + std::to_string(d));
      const LatticeKernel kernel = latticeAround(cloud.features);
      PlainLattice plain = plainLatticeLike(kernel.lattice(), cloud.features);
      ASSERT_EQ(kernel.lattice().vertices, std::size_t(plain.vertices()));
      const Eigen::MatrixXf values = makeNormalCloud(4, count, 1.0f, 6);
      const Eigen::MatrixXf forward = plainlyFiltered(plain, values, false);
      const Eigen::MatrixXf reverse = plainlyFiltered(plain, values, true);
      const float tolerance = 5e-5f * forward.cwiseAbs().maxCoeff();
      const Eigen::MatrixXf error =
          filtered(kernel, values) - 0.5f * (forward + reverse);
      EXPECT_LT(error.cwiseAbs().maxCoeff(), tolerance);
    }
  }
}

TEST(PermutohedralLattice, SelfResponsesAreWhatOnesSendBack)
{
  for (const Eigen::Index d : {1, 2, 3, 5, 6, 7, 8, 10, 16})
    for (const Cloud& cloud : cloudsOf(d, 300)) {
      SCOPED_TRACE(std::string(cloud.name) + ", d " + std::to_string(d));
      const LatticeKernel kernel = latticeAround(cloud.features);
      const Eigen::ArrayXf& responses = kernel.lattice().self_responses;
      const Eigen::MatrixXf sent =
          filtered(kernel, Eigen::MatrixXf::Identity(300, 300));
      const Eigen::ArrayXf error = responses - sent.diagonal().array();
      EXPECT_LT((error / sent.diagonal().array()).abs().maxCoeff(), 1e-5f);
      PlainLattice plain = plainLatticeLike(kernel.lattice(), cloud.features);
      const Eigen::ArrayXf plain_responses = plain.selfResponse() / plain.gain();
      EXPECT_LT((responses - plain_responses).abs().maxCoeff(), 2e-5f);
    }
}

TEST(PermutohedralLattice, IsASymmetricMap)
{
  for (const Eigen::Index d : {2, 3, 5, 6}) {
    const LatticeKernel kernel = latticeAround(makeNormalCloud(d, 400, 2.0f, 7));
    const Eigen::MatrixXf matrix =
        filtered(kernel, Eigen::MatrixXf::Identity(400, 400));
    EXPECT_LT((matrix - matrix.transpose()).norm(), 1e-6f * matrix.norm()) << "d " << d;
  }
}

TEST(PermutohedralLattice, GainMakesSumsThoseOfTheGaussian)
{
  for (const Eigen::Index d : {1, 2, 3}) {
    // Enough points that every vertex exists at the evaluated ones.
    const Eigen::MatrixXf features = 4.0f * Eigen::MatrixXf::Random(d, 4000);
    const LatticeKernel kernel = latticeAround(features);
    const Eigen::MatrixXf sums = filtered(kernel, Eigen::MatrixXf::Ones(1, 4000));
    const Eigen::MatrixXd exact = makeGaussianMatrix(features);
    double ratio = 0.0, inside = 0.0;
    for (Eigen::Index i = 0; i < 4000; ++i)
      if (features.col(i).cwiseAbs().maxCoeff() < 1.5f) {
        ratio += double(kernel.lattice().gain() * sums(0, i)) / exact.col(i).sum();
        inside += 1.0;
      }
    EXPECT_NEAR(ratio / inside, 1.0, 0.03) << "d " << d;
  }
}

TEST(PermutohedralLattice, MovedFeaturesGiveTheSameSums)
{
  for (const Eigen::Index d : {2, 3, 6}) {
    // Voxels of 0.1 m at a deviation of 0.2 m, then 100 km away: exact in floats.
    const Eigen::MatrixXf features = makeVoxelSurface(d, 2000, 8);
    Eigen::MatrixXf moved = features;
    moved.topRows(2).array() += 500000.0f;
    const Eigen::MatrixXf values = makeNormalCloud(8, 2000, 1.0f, 9);
    const LatticeKernel here = latticeAround(features), there = latticeAround(moved);
    EXPECT_EQ(here.lattice().vertices, there.lattice().vertices);
    EXPECT_TRUE(product(here, values) == product(there, values));
    // By a distance after which features are rounded to 2^-13 of a deviation.
    moved = makeNormalCloud(d, 2000, 1.0f, 10);
    const LatticeKernel near = latticeAround(moved);
    moved.array() += 1234.567f;
    const Eigen::MatrixXf sums = filtered(near, values);
    const Eigen::MatrixXf error = filtered(latticeAround(moved), values) - sums;
    EXPECT_LT(error.norm(), 5e-3f * sums.norm());
  }
}

TEST(PermutohedralLattice, PermutedPointsGiveTheSameSums)
{
  const Eigen::Index count = 3000;
  const Eigen::MatrixXf features = makeVoxelSurface(5, count, 11);
  const Eigen::MatrixXf values = makeNormalCloud(3, count, 1.0f, 12);
  const Eigen::MatrixXf sums = filtered(latticeAround(features), values);
  const Eigen::MatrixXf reversed =
      filtered(latticeAround(features.rowwise().reverse()), values.rowwise().reverse());
  EXPECT_LT((sums - reversed.rowwise().reverse()).cwiseAbs().maxCoeff(),
            1e-5f * sums.cwiseAbs().maxCoeff());
}

TEST(PermutohedralLattice, KeysOf128BitsGiveTheSameSumsAsThoseOf64)
{
  // A point far away in every direction widens the keys and changes nothing else.
  const Eigen::Index d = 6, count = 1000;
  Eigen::MatrixXf features(d, count + 1);
  features << makeNormalCloud(d, count, 1.0f, 13),
      Eigen::VectorXf::Constant(d, 100000.0f);
  Eigen::MatrixXf near = features;
  near.col(count).setConstant(30.0f);
  const Eigen::MatrixXf values = makeNormalCloud(2, count + 1, 1.0f, 14);
  const Eigen::MatrixXf wide = product(latticeAround(features), values);
  const Eigen::MatrixXf narrow = product(latticeAround(near), values);
  EXPECT_TRUE(wide.leftCols(count) == narrow.leftCols(count));
}

TEST(PermutohedralLattice, NoPointsOnePointAndPointsInOnePlace)
{
  const LatticeKernel none = latticeAround(Eigen::MatrixXf(3, 0));
  EXPECT_EQ(none.size(), 0);
  product(none, Eigen::MatrixXf(2, 0));
  for (const Eigen::Index count : {1, 2, 63, 64, 65, 5000}) {
    const LatticeKernel kernel =
        latticeAround(Eigen::MatrixXf::Constant(3, count, 7.0f));
    EXPECT_EQ(kernel.lattice().vertices, 4u);
    const Eigen::MatrixXf sums = filtered(kernel, Eigen::MatrixXf::Ones(1, count));
    for (Eigen::Index i = 0; i < count; ++i)
      EXPECT_NEAR(sums(0, i), kernel.lattice().self_responses[i] * float(count),
                  2e-5f * sums(0, 0));
  }
}

TEST(PermutohedralLattice, RefusesWhatHasNoKeys)
{
  const auto refused = [](const Eigen::MatrixXf& features) {
    EXPECT_THROW(PermutohedralLattice{features}, InvalidParameterException);
  };
  Eigen::MatrixXf features = Eigen::MatrixXf::Random(4, 300);
  features(2, 299) = std::nanf("");
  refused(features);
  features(2, 299) = std::numeric_limits<float>::infinity();
  refused(features);
  features(2, 299) = 1e30f;
  refused(features);
  refused(Eigen::MatrixXf(0, 300));
  refused(Eigen::MatrixXf::Random(17, 300));
  refused(10000.0f * Eigen::MatrixXf::Random(16, 300)); // more than 128 bits
  // The extents of the documentation are possible.
  const Eigen::MatrixXf possible = 25.0f * Eigen::MatrixXf::Random(16, 300);
  EXPECT_EQ(PermutohedralLattice(possible).points, 300u);
}

// The matrix of the exact Gaussian, normalised and weighted, without its diagonal.
Eigen::MatrixXd
exactMatrix(const Eigen::MatrixXf& features, Normalization normalization)
{
  Eigen::MatrixXd matrix = makeGaussianMatrix(features);
  const Eigen::ArrayXd scale = matrix.rowwise().sum().array().rsqrt();
  if (normalization == Normalization::symmetric)
    matrix = scale.matrix().asDiagonal() * matrix * scale.matrix().asDiagonal();
  if (normalization == Normalization::one_sided)
    matrix = scale.square().matrix().asDiagonal() * matrix;
  matrix.diagonal().setZero();
  return double(weight) * matrix;
}

// Error of products with labellings of eight classes, relative to the products.
double
relativeError(const Eigen::MatrixXf& features, Normalization normalization)
{
  const LatticeKernel kernel(features, weight, normalization);
  Eigen::MatrixXf values = Eigen::MatrixXf::Zero(8, features.cols());
  std::mt19937 random(1);
  for (Eigen::Index i = 0; i < features.cols(); ++i)
    values(Eigen::Index(random() % 8), i) = 1.0f;
  const Eigen::MatrixXd expected =
      values.cast<double>() * exactMatrix(features, normalization).transpose();
  return (product(kernel, values).cast<double>() - expected).norm() / expected.norm();
}

TEST(LatticeKernel, IsNearTheBruteForceSum)
{
  // The lattice approximates: better, the more points lie within a deviation.
  const struct {
    Eigen::Index dimensions;
    double dense, clusters, voxels;
  } bounds[] = {{1, 0.01, 0.015, 0.01},
                {2, 0.02, 0.02, 0.04},
                {3, 0.02, 0.03, 0.05},
                {5, 0.03, 0.035, 0.07},
                {6, 0.04, 0.04, 0.08}};
  for (const auto& bound : bounds) {
    const Eigen::Index d = bound.dimensions;
    const auto symmetric = Normalization::symmetric;
    EXPECT_LT(relativeError(makeNormalCloud(d, 1500, 0.7f, 1), symmetric), bound.dense)
        << "d " << d;
    EXPECT_LT(relativeError(makeClusters(d, 1500, 2), symmetric), bound.clusters)
        << "d " << d;
    EXPECT_LT(relativeError(makeVoxelSurface(d, 1500, 3), symmetric), bound.voxels)
        << "d " << d;
  }
}

TEST(LatticeKernel, IsNearTheBruteForceSumInEveryNormalization)
{
  const Eigen::MatrixXf features = makeNormalCloud(3, 1500, 1.0f, 4);
  EXPECT_LT(relativeError(features, Normalization::symmetric), 0.02);
  EXPECT_LT(relativeError(features, Normalization::one_sided), 0.02);
  EXPECT_LT(relativeError(features, Normalization::none), 0.05);
}

TEST(LatticeKernel, NormalizationIsExactForTheLatticeItself)
{
  const Eigen::MatrixXf features = makeNormalCloud(5, 400, 1.5f, 5);
  const Eigen::MatrixXf identity = Eigen::MatrixXf::Identity(400, 400);
  const auto matrixOf = [&](Normalization normalization) {
    const LatticeKernel kernel(features, weight, normalization);
    Eigen::MatrixXf matrix = product(kernel, identity).transpose();
    matrix.diagonal() += diagonalOf(kernel);
    return matrix;
  };
  const Eigen::MatrixXf plain = matrixOf(Normalization::none) / weight;
  const Eigen::ArrayXf sums = plain.rowwise().sum().array();
  const Eigen::MatrixXf one_sided =
      weight * sums.inverse().matrix().asDiagonal() * plain;
  const Eigen::MatrixXf symmetric = weight * sums.rsqrt().matrix().asDiagonal() *
                                    plain * sums.rsqrt().matrix().asDiagonal();
  EXPECT_LT((matrixOf(Normalization::one_sided) - one_sided).cwiseAbs().maxCoeff(),
            1e-5f);
  EXPECT_LT((matrixOf(Normalization::symmetric) - symmetric).cwiseAbs().maxCoeff(),
            1e-5f);
  EXPECT_LT((symmetric - symmetric.transpose()).cwiseAbs().maxCoeff(), 1e-5f);
}

TEST(LatticeKernel, ProductsLeaveOutTheVariableItself)
{
  for (const Eigen::Index d : {1, 3, 6, 9}) {
    const LatticeKernel kernel(makeNormalCloud(d, 300, 1.0f, 6), weight);
    const Eigen::MatrixXf matrix = product(kernel, Eigen::MatrixXf::Identity(300, 300));
    EXPECT_LT(matrix.diagonal().cwiseAbs().maxCoeff(), 1e-5f) << "d " << d;
    EXPECT_GT(diagonalOf(kernel).minCoeff(), 0.001f) << "d " << d;
  }
}

TEST(LatticeKernel, OneVariableHearsNothing)
{
  const LatticeKernel kernel(Eigen::MatrixXf::Constant(3, 1, 5.0f), weight);
  EXPECT_NEAR(kernel.diagonal(0), weight, 1e-5f);
  EXPECT_NEAR(product(kernel, Eigen::MatrixXf::Ones(2, 1)).cwiseAbs().maxCoeff(), 0.0f,
              1e-5f);
}

TEST(LatticeKernel, EveryNumberOfRowsIsDoneRowByRow)
{
  const Eigen::Index count = 700;
  const LatticeKernel kernel(makeNormalCloud(4, count, 1.0f, 7), weight);
  const Eigen::MatrixXf values = makeNormalCloud(255, count, 1.0f, 8);
  Eigen::MatrixXf expected(255, count);
  for (Eigen::Index row = 0; row < 255; ++row)
    expected.row(row) = product(kernel, values.row(row));
  for (const Eigen::Index rows : {1, 2, 3, 4, 5, 8, 9, 11, 15, 16, 17, 19, 33, 255})
    EXPECT_TRUE(product(kernel, values.topRows(rows)) == expected.topRows(rows))
        << rows << " rows";
}

TEST(LatticeKernel, AddsToBlocksOfLargerMatricesAndNothingElse)
{
  const Eigen::Index count = 300;
  const LatticeKernel kernel(makeNormalCloud(2, count, 1.0f, 9), weight);
  Eigen::MatrixXf values = makeNormalCloud(24, count, 1.0f, 10);
  const Eigen::MatrixXf before = makeNormalCloud(32, count, 1.0f, 11);
  for (const Eigen::Index rows : {3, 11, 16, 19}) {
    Eigen::MatrixXf result = before;
    kernel.addProduct(values.middleRows(2, rows), result.middleRows(5, rows));
    Eigen::MatrixXf expected = before;
    expected.middleRows(5, rows) += product(kernel, values.middleRows(2, rows));
    EXPECT_LT((result - expected).cwiseAbs().maxCoeff(), 1e-6f);
    expected.middleRows(5, rows) = result.middleRows(5, rows);
    EXPECT_TRUE(result == expected) << rows << " rows";
  }
}

TEST(LatticeKernel, SameBitsForAnyNumberOfThreads)
{
  const Eigen::Index count = 20000;
  for (const Eigen::Index d : {2, 5}) {
    const Eigen::MatrixXf features = makeVoxelSurface(d, count, 14);
    const Eigen::MatrixXf values = makeNormalCloud(11, count, 1.0f, 15);
    std::vector<Eigen::MatrixXf> results;
    for (const int threads : {1, 2, 7}) {
      setNumberOfThreads(threads);
      results.push_back(product(LatticeKernel(features, weight), values));
    }
    setNumberOfThreads(0);
    EXPECT_TRUE(results[0] == results[1]);
    EXPECT_TRUE(results[0] == results[2]);
  }
}

TEST(LatticeKernel, SameBitsInEverySimdTier)
{
  const Eigen::Index count = 700;
  for (const Eigen::Index d : {1, 2, 5, 6, 8}) {
    const Eigen::MatrixXf features = makeNormalCloud(d, count, 2.0f, 16);
    for (const Eigen::Index rows : {1, 3, 7, 11, 16, 19}) {
      const Eigen::MatrixXf values = makeNormalCloud(rows, count, 1.0f, 17);
      const auto inTier = [&](SimdTier tier) {
        return product(LatticeKernel(features, weight, Normalization::symmetric, tier),
                       values);
      };
      const Eigen::MatrixXf plain = inTier(SimdTier::plain);
      for (const SimdTier tier : supportedTiers())
        EXPECT_TRUE(inTier(tier) == plain)
            << nameOf(tier) << ", d " << d << ", " << rows << " rows";
    }
  }
}

TEST(LatticeKernel, ThreadsMayShareOne)
{
  const Eigen::Index count = 5000;
  const LatticeKernel kernel(makeNormalCloud(3, count, 1.0f, 18), weight);
  const Eigen::MatrixXf values = makeNormalCloud(8, count, 1.0f, 19);
  const Eigen::MatrixXf expected = product(kernel, values);
  std::vector<Eigen::MatrixXf> results(4);
  std::vector<std::thread> threads;
  for (Eigen::MatrixXf& result : results)
    threads.emplace_back([&] {
      for (int i = 0; i < 5; ++i)
        result = product(kernel, values);
    });
  for (std::thread& thread : threads)
    thread.join();
  for (const Eigen::MatrixXf& result : results)
    EXPECT_TRUE(result == expected);
}

TEST(LatticeKernel, RefusesWhatCannotWork)
{
  const Eigen::MatrixXf features = makeNormalCloud(3, 10, 1.0f, 20);
  for (const float bad : {-1.0f, std::nanf(""), INFINITY})
    EXPECT_THROW(LatticeKernel(features, bad), InvalidParameterException);
  EXPECT_THROW(LatticeKernel(features * std::nanf("")), InvalidParameterException);
  const LatticeKernel nothing(features, 0.0f);
  EXPECT_EQ(product(nothing, Eigen::MatrixXf::Ones(2, 10)).norm(), 0.0f);
}

} // namespace

// A part of the points has the same lattice if it knows the minimum of all of them.
TEST(LatticeKernel, OfAPartIsThatOfTheWhole)
{
  const Eigen::MatrixXf part = makeRandomMatrix(4, 300, 0.0f, 6.0f, 21);
  Eigen::MatrixXf whole(4, 400);
  whole << part, makeRandomMatrix(4, 100, -60.3f, -40.0f, 22);
  Eigen::MatrixXf values = Eigen::MatrixXf::Zero(3, 400);
  values.leftCols(300) = makeRandomMatrix(3, 300, 0.0f, 1.0f, 23);
  const Eigen::MatrixXf expected = product(LatticeKernel(whole), values).leftCols(300);
  const auto partWith = [&](const Eigen::VectorXf& lows) {
    return product(
        LatticeKernel(part, 1.0f, Normalization::symmetric, simdTier(), lows),
        values.leftCols(300));
  };
  const float scale = expected.cwiseAbs().maxCoeff();
  EXPECT_LT((partWith(whole.rowwise().minCoeff()) - expected).cwiseAbs().maxCoeff(),
            1e-5f * scale);
  EXPECT_GT((partWith({}) - expected).cwiseAbs().maxCoeff(), 1e-3f * scale);
}
