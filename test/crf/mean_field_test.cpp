/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "support/brute_force_crf.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/mean_field.h>

#include <gtest/gtest.h>

namespace {

using namespace pcl_semantic;

struct Problem {
  Eigen::Matrix3Xf positions;
  std::vector<GaussianTerm> terms;
  CrfModel model;

  explicit Problem(Eigen::Index count, int labels, float weight, unsigned seed)
      : positions(makeVoxelPositions(count, seed)),
        terms({{weight, 0.2f, Eigen::MatrixXf()}})
  {
    model.unary = makeRandomMatrix(labels, count, 0.0f, 3.0f, seed + 1);
    model.kernels.push_back(std::make_shared<TruncatedKernel>(positions, terms, 10.0f));
  }
};

TEST(MeanField, UpdatesEqualAPlainImplementation)
{
  const Problem problem(500, 6, 5.0f, 1);
  MeanField inference(problem.model);
  const Eigen::MatrixXd kernel =
      makeKernelMatrix(problem.positions, problem.terms, 2.0);
  for (int iteration = 0; iteration <= 5; ++iteration) {
    const Eigen::MatrixXd expected =
        plainMeanField(problem.model.unary.cast<double>(), kernel, iteration);
    EXPECT_LT((inference.marginals().cast<double>() - expected).cwiseAbs().maxCoeff(),
              1e-4)
        << "after " << iteration << " updates";
    inference.update();
  }
}

// Exact marginals of a small graph: all labellings, weighted by their energy.
Eigen::MatrixXd
enumerate(const Eigen::MatrixXd& unary, const Eigen::MatrixXd& kernel)
{
  const Eigen::Index count = unary.cols(), labels = unary.rows();
  Eigen::MatrixXd marginals = Eigen::MatrixXd::Zero(labels, count);
  std::vector<Eigen::Index> x(std::size_t(count), 0);
  for (bool more = true; more;) {
    double energy = 0.0;
    for (Eigen::Index i = 0; i < count; ++i) {
      energy += unary(x[i], i);
      for (Eigen::Index j = 0; j < i; ++j)
        energy += x[i] != x[j] ? kernel(i, j) : 0.0;
    }
    for (Eigen::Index i = 0; i < count; ++i)
      marginals(x[i], i) += std::exp(-energy);
    more = false;
    for (Eigen::Index i = 0; i < count && !more; ++i) {
      x[i] = (x[i] + 1) % labels;
      more = x[i] != 0;
    }
  }
  return marginals / marginals.col(0).sum();
}

double
errorAgainstEnumeration(float weight)
{
  const Problem problem(7, 3, weight, 2);
  MeanField inference(problem.model);
  for (int i = 0; i < 100; ++i)
    inference.update();
  const Eigen::MatrixXd exact =
      enumerate(problem.model.unary.cast<double>(),
                makeKernelMatrix(problem.positions, problem.terms, 2.0));
  return (inference.marginals().cast<double>() - exact).cwiseAbs().maxCoeff();
}

TEST(MeanField, ApproachesTheExactMarginalsAsCouplingsVanish)
{
  // Mean field is exact to first order: halving the couplings at least thirds the
  // error.
  const double strong = errorAgainstEnumeration(0.8f);
  const double weak = errorAgainstEnumeration(0.4f);
  EXPECT_GT(strong, 1e-4);
  EXPECT_LT(weak, strong / 3.0);
}

TEST(MeanField, WithoutKernelsTheUnaryIsTheAnswer)
{
  CrfModel model;
  model.unary = makeRandomMatrix(4, 20, 0.0f, 5.0f, 3);
  MeanField inference(model);
  inference.update();
  EXPECT_LT(
      (inference.marginals().cast<double>() - softMax(-model.unary.cast<double>()))
          .cwiseAbs()
          .maxCoeff(),
      1e-6);
}

TEST(MeanField, RefusesWhatDoesNotFit)
{
  Problem problem(20, 3, 1.0f, 4);
  problem.model.unary = Eigen::MatrixXf::Zero(3, 19);
  EXPECT_THROW(MeanField{problem.model}, InvalidParameterException);
  problem.model.unary = Eigen::MatrixXf::Constant(3, 20, INFINITY);
  EXPECT_THROW(MeanField{problem.model}, InvalidParameterException);
}

} // namespace
