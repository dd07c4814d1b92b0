// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "crf/truncated_kernel.h"

#include <cmath>
#include <limits>
#include <random>

namespace pcl_semantic {

/** \brief A kernel matrix written straight from eq. (6) in double precision: all pairs
 * within \a radius, each term normalised as D^-1/2 K D^-1/2, its diagonal left out. */
inline Eigen::MatrixXd
makeKernelMatrix(const Eigen::Matrix3Xf& positions,
                 const std::vector<GaussianTerm>& terms,
                 double radius = std::numeric_limits<double>::infinity())
{
  const Eigen::Index count = positions.cols();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(count, count);
  for (const GaussianTerm& term : terms) {
    Eigen::MatrixXd kernel = Eigen::MatrixXd::Zero(count, count);
    for (Eigen::Index i = 0; i < count; ++i)
      for (Eigen::Index j = 0; j < count; ++j) {
        const double distance =
            (positions.col(i) - positions.col(j)).cast<double>().norm();
        if (distance > radius)
          continue;
        double exponent = std::pow(distance / double(term.position_deviation), 2);
        if (term.features.size() > 0)
          exponent += (term.features.col(i) - term.features.col(j))
                          .cast<double>()
                          .squaredNorm();
        kernel(i, j) = std::exp(-0.5 * exponent);
      }
    const Eigen::ArrayXd scale = kernel.rowwise().sum().array().rsqrt();
    for (Eigen::Index i = 0; i < count; ++i)
      for (Eigen::Index j = 0; j < count; ++j)
        if (i != j)
          sum(i, j) += double(term.weight) * kernel(i, j) * scale(i) * scale(j);
  }
  return sum;
}

/** \brief Columns of exp(values) that sum to one. */
inline Eigen::MatrixXd
softMax(Eigen::MatrixXd values)
{
  for (Eigen::Index i = 0; i < values.cols(); ++i) {
    values.col(i) = (values.col(i).array() - values.col(i).maxCoeff()).exp();
    values.col(i) /= values.col(i).sum();
  }
  return values;
}

/** \brief Parallel mean-field updates of a Potts model, in double precision. */
inline Eigen::MatrixXd
plainMeanField(const Eigen::MatrixXd& unary, const Eigen::MatrixXd& kernel,
               int iterations)
{
  Eigen::MatrixXd marginals = softMax(-unary);
  for (int i = 0; i < iterations; ++i)
    marginals = softMax(-unary + marginals * kernel.transpose());
  return marginals;
}

/** \brief Points on a grid of 0.1, most of them in a slab, as voxels on a surface. */
inline Eigen::Matrix3Xf
makeVoxelPositions(Eigen::Index count, unsigned seed)
{
  std::mt19937 random(seed);
  Eigen::Matrix3Xf positions(3, count);
  for (Eigen::Index i = 0; i < count; ++i)
    positions.col(i) << 0.1f * float(random() % 20), 0.1f * float(random() % 20),
        0.1f * float(random() % 3);
  return positions;
}

/** \brief Uniform random numbers. */
inline Eigen::MatrixXf
makeRandomMatrix(Eigen::Index rows, Eigen::Index columns, float low, float high,
                 unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(low, high);
  return Eigen::MatrixXf::NullaryExpr(rows, columns, [&] { return value(random); });
}

} // namespace pcl_semantic
