// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <random>

namespace pcl_semantic {

/** \brief Normally distributed features (d x N). */
inline Eigen::MatrixXf
makeNormalCloud(Eigen::Index dimensions, Eigen::Index count, float deviation,
                unsigned seed)
{
  std::mt19937 random(seed);
  std::normal_distribution<float> value(0.0f, deviation);
  return Eigen::MatrixXf::NullaryExpr(dimensions, count, [&] { return value(random); });
}

/** \brief Points in a few distant clusters. */
inline Eigen::MatrixXf
makeClusters(Eigen::Index dimensions, Eigen::Index count, unsigned seed)
{
  const Eigen::MatrixXf centres = makeNormalCloud(dimensions, 5, 8.0f, seed);
  Eigen::MatrixXf features = makeNormalCloud(dimensions, count, 0.5f, seed + 1);
  for (Eigen::Index i = 0; i < count; ++i)
    features.col(i) += centres.col(i % 5);
  return features;
}

/** \brief Voxels of half a deviation on a curved surface (first three features). The
 * others are integers divided by four, similar to colours. */
inline Eigen::MatrixXf
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

/** \brief The Gaussian exp(-|f_i - f_j|^2 / 2) of all pairs, in double precision. */
inline Eigen::MatrixXd
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

} // namespace pcl_semantic
