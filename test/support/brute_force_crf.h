// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "crf/truncated_kernel.h"

#include <cmath>
#include <limits>
#include <random>

namespace pcl_semantic {

/** \brief exp(-(|x_i - x_j|^2 / deviation^2 + |f_i - f_j|^2) / 2) of all pairs within
 * \a radius, otherwise 0.
 * \param[in] features divided by their deviations; may be empty */
inline Eigen::MatrixXd
gaussianMatrix(const Eigen::MatrixXf& positions, const Eigen::MatrixXf& features,
               double deviation, double radius)
{
  const auto squared = [](const Eigen::MatrixXf& x, Eigen::Index i, Eigen::Index j) {
    return (x.col(i) - x.col(j)).cast<double>().squaredNorm();
  };
  const Eigen::Index count = positions.cols();
  Eigen::MatrixXd kernel = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j) {
      const double distance = std::sqrt(squared(positions, i, j));
      const double exponent = std::pow(distance / deviation, 2) +
                              (features.size() > 0 ? squared(features, i, j) : 0.0);
      if (distance <= radius)
        kernel(i, j) = std::exp(-0.5 * exponent);
    }
  return kernel;
}

/** \brief A kernel matrix directly from eq. (6) in double precision: all pairs within
 * \a radius, each term normalised as D^-1/2 K D^-1/2, without its diagonal. */
inline Eigen::MatrixXd
makeKernelMatrix(const Eigen::Matrix3Xf& positions,
                 const std::vector<GaussianTerm>& terms,
                 double radius = std::numeric_limits<double>::infinity())
{
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(positions.cols(), positions.cols());
  for (const GaussianTerm& term : terms) {
    const Eigen::MatrixXd kernel = gaussianMatrix(
        positions, term.features, double(term.position_deviation), radius);
    const Eigen::VectorXd scale = kernel.rowwise().sum().array().rsqrt();
    sum += double(term.weight) * (scale.asDiagonal() * kernel * scale.asDiagonal());
  }
  sum.diagonal().setZero();
  return sum;
}

/** \brief Columns of exp(values), normalised to sum to one. */
inline Eigen::MatrixXd
softMax(Eigen::MatrixXd values)
{
  for (Eigen::Index i = 0; i < values.cols(); ++i) {
    values.col(i) = (values.col(i).array() - values.col(i).maxCoeff()).exp();
    values.col(i) /= values.col(i).sum();
  }
  return values;
}

/** \brief Points on a grid of 0.1, most of them in a slab, similar to voxels on a
 * surface. */
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

inline Eigen::MatrixXf
makeRandomMatrix(Eigen::Index rows, Eigen::Index columns, float low, float high,
                 unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(low, high);
  return Eigen::MatrixXf::NullaryExpr(rows, columns, [&] { return value(random); });
}

} // namespace pcl_semantic
