// SPDX-License-Identifier: BSD-3-Clause
#include "crf/permutohedral_lattice.h"
#include "support/feature_clouds.h"
#include "support/plain_lattice.h"

#include <pcl_semantic/core/exceptions.h>

#include <gtest/gtest.h>

#include <limits>

namespace {

using namespace pcl_semantic;

Eigen::MatrixXf
filtered(const PermutohedralLattice& lattice, const Eigen::MatrixXf& values)
{
  Eigen::MatrixXf result = Eigen::MatrixXf::Zero(values.rows(), values.cols());
  const Eigen::Index count = lattice.size();
  lattice.addFiltered(values,
                      {Eigen::ArrayXf::Ones(count), Eigen::ArrayXf::Ones(count),
                       Eigen::ArrayXf::Zero(count)},
                      result);
  return result;
}

// The plain lattice around points at the places where the fast one has them.
PlainLattice
plainLatticeLike(const PermutohedralLattice& lattice, const Eigen::MatrixXf& features)
{
  Eigen::MatrixXf moved = features;
  moved.colwise() -= lattice.origin().cast<float>();
  return PlainLattice(moved);
}

// What the plain one makes of four rows, without its constant factor.
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
    // Enough for several chunks. Of more corners in sparser clouds some would lie on
    // the border of simplices but for rounding.
    const Eigen::Index count = d < 9 ? 3000 : 800;
    for (const Cloud& cloud : cloudsOf(d, count)) {
      SCOPED_TRACE(std::string(cloud.name) + ", d " + std::to_string(d));
      const PermutohedralLattice lattice(cloud.features);
      PlainLattice plain = plainLatticeLike(lattice, cloud.features);
      ASSERT_EQ(lattice.vertices(), plain.vertices());
      const Eigen::MatrixXf values = makeNormalCloud(4, count, 1.0f, 6);
      const Eigen::MatrixXf forward = plainlyFiltered(plain, values, false);
      const Eigen::MatrixXf reverse = plainlyFiltered(plain, values, true);
      const float tolerance = 5e-5f * forward.cwiseAbs().maxCoeff();
      const Eigen::MatrixXf error =
          filtered(lattice, values) - 0.5f * (forward + reverse);
      EXPECT_LT(error.cwiseAbs().maxCoeff(), tolerance);
    }
  }
}

TEST(PermutohedralLattice, SelfResponsesAreWhatOnesSendBack)
{
  for (const Eigen::Index d : {1, 2, 3, 5, 6, 7, 8, 10, 16})
    for (const Cloud& cloud : cloudsOf(d, 300)) {
      SCOPED_TRACE(std::string(cloud.name) + ", d " + std::to_string(d));
      const PermutohedralLattice lattice(cloud.features);
      const Eigen::MatrixXf sent =
          filtered(lattice, Eigen::MatrixXf::Identity(300, 300));
      const Eigen::ArrayXf error = lattice.selfResponses() - sent.diagonal().array();
      EXPECT_LT((error / sent.diagonal().array()).abs().maxCoeff(), 1e-5f);
      PlainLattice plain = plainLatticeLike(lattice, cloud.features);
      const Eigen::ArrayXf plain_responses = plain.selfResponse() / plain.gain();
      EXPECT_LT((lattice.selfResponses() - plain_responses).abs().maxCoeff(), 2e-5f);
    }
}

TEST(PermutohedralLattice, IsASymmetricMap)
{
  for (const Eigen::Index d : {2, 3, 5, 6}) {
    const PermutohedralLattice lattice(makeNormalCloud(d, 400, 2.0f, 7));
    const Eigen::MatrixXf matrix =
        filtered(lattice, Eigen::MatrixXf::Identity(400, 400));
    EXPECT_LT((matrix - matrix.transpose()).norm(), 1e-6f * matrix.norm()) << "d " << d;
  }
}

TEST(PermutohedralLattice, GainMakesSumsThoseOfTheGaussian)
{
  for (const Eigen::Index d : {1, 2, 3}) {
    // So many points that every vertex exists where the sum is looked at.
    const Eigen::MatrixXf features = 4.0f * Eigen::MatrixXf::Random(d, 4000);
    const PermutohedralLattice lattice(features);
    const Eigen::MatrixXf sums = filtered(lattice, Eigen::MatrixXf::Ones(1, 4000));
    const Eigen::MatrixXd exact = makeGaussianMatrix(features);
    double ratio = 0.0, inside = 0.0;
    for (Eigen::Index i = 0; i < 4000; ++i)
      if (features.col(i).cwiseAbs().maxCoeff() < 1.5f) {
        ratio += double(lattice.gain() * sums(0, i)) / exact.col(i).sum();
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
    const PermutohedralLattice here(features), there(moved);
    EXPECT_EQ(here.vertices(), there.vertices());
    EXPECT_TRUE(filtered(here, values) == filtered(there, values));
    // By a distance after which features are rounded to 2^-13 of a deviation.
    moved = makeNormalCloud(d, 2000, 1.0f, 10);
    const PermutohedralLattice near(moved);
    moved.array() += 1234.567f;
    const Eigen::MatrixXf sums = filtered(near, values);
    const Eigen::MatrixXf error = filtered(PermutohedralLattice(moved), values) - sums;
    EXPECT_LT(error.norm(), 5e-3f * sums.norm());
  }
}

TEST(PermutohedralLattice, PermutedPointsGiveTheSameSums)
{
  const Eigen::Index count = 3000;
  const Eigen::MatrixXf features = makeVoxelSurface(5, count, 11);
  const Eigen::MatrixXf values = makeNormalCloud(3, count, 1.0f, 12);
  const Eigen::MatrixXf sums = filtered(PermutohedralLattice(features), values);
  const Eigen::MatrixXf reversed = filtered(
      PermutohedralLattice(features.rowwise().reverse()), values.rowwise().reverse());
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
  const Eigen::MatrixXf wide = filtered(PermutohedralLattice(features), values);
  const Eigen::MatrixXf narrow = filtered(PermutohedralLattice(near), values);
  EXPECT_TRUE(wide.leftCols(count) == narrow.leftCols(count));
}

TEST(PermutohedralLattice, NoPointsOnePointAndPointsInOnePlace)
{
  EXPECT_EQ(PermutohedralLattice(Eigen::MatrixXf(3, 0)).size(), 0);
  filtered(PermutohedralLattice(Eigen::MatrixXf(3, 0)), Eigen::MatrixXf(2, 0));
  for (const Eigen::Index count : {1, 2, 63, 64, 65, 5000}) {
    const PermutohedralLattice lattice(Eigen::MatrixXf::Constant(3, count, 7.0f));
    EXPECT_EQ(lattice.vertices(), 4);
    const Eigen::MatrixXf sums = filtered(lattice, Eigen::MatrixXf::Ones(1, count));
    for (Eigen::Index i = 0; i < count; ++i)
      EXPECT_NEAR(sums(0, i), lattice.selfResponses()[i] * float(count),
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
  EXPECT_EQ(PermutohedralLattice(possible).size(), 300);
}

} // namespace
