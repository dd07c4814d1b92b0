// SPDX-License-Identifier: BSD-3-Clause

// Labelled clouds, and their CRF as explicit matrices.

#pragma once

#include "core/point_spacing.h"
#include "crf/truncated_kernel.h"
#include "support/brute_force_crf.h"
#include "support/plain_crf.h"

#include <pcl_semantic/filters/semantic_crf.h>

#include <numeric>
#include <random>

namespace pcl_semantic {

/** \brief A cloud of voxels with random colours, four classes and label 99. */
struct CrfCloud {
  pcl::PointCloud<pcl::PointXYZRGBL>::Ptr cloud{new pcl::PointCloud<pcl::PointXYZRGBL>};
  LabelDistributions distributions;
};

inline CrfCloud
makeCrfCloud(Eigen::Index count, unsigned seed)
{
  CrfCloud result;
  const Eigen::Matrix3Xf positions = makeVoxelPositions(count, seed);
  std::mt19937 random(seed);
  for (Eigen::Index i = 0; i < count; ++i) {
    pcl::PointXYZRGBL point;
    point.getVector3fMap() = positions.col(i);
    point.r = static_cast<std::uint8_t>(100 + random() % 30);
    point.g = static_cast<std::uint8_t>(100 + random() % 30);
    point.b = static_cast<std::uint8_t>(100 + random() % 30);
    point.label = 99;
    result.cloud->push_back(point);
  }
  result.distributions =
      LabelDistributions(makeRandomMatrix(4, count, 0.05f, 1.0f, seed + 1));
  return result;
}

using CrfFilter = SemanticCRF<pcl::PointXYZRGBL>;

/** \brief Refines a cloud with a prepared filter. \return the distributions
 * \param[out] output the filter's cloud, if asked for */
inline Eigen::MatrixXf
refine(CrfFilter& crf, const CrfCloud& input,
       pcl::PointCloud<pcl::PointXYZRGBL>* output = nullptr)
{
  pcl::PointCloud<pcl::PointXYZRGBL> own;
  crf.setInputCloud(input.cloud);
  crf.setLabelDistributions(input.distributions);
  crf.filter(output ? *output : own);
  return crf.getLabelDistributions().matrix();
}

inline CrfFilter
filterWith(const SemanticCRFParameters& parameters)
{
  CrfFilter crf;
  crf.setParameters(parameters);
  return crf;
}

/** \brief The largest difference of two matrices' elements. */
inline float
largestDifference(const Eigen::MatrixXf& a, const Eigen::MatrixXf& b)
{
  return (a - b).cwiseAbs().maxCoeff();
}

inline pcl::Indices
allIndices(std::size_t count)
{
  pcl::Indices indices(count);
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

/** \brief w k_ij of eq. (6) with its diagonal, as in a truncated kernel: all pairs
 * within the radius, with the widened position deviation.
 * \param[in] features d x N, divided by their deviations; may be empty */
inline Eigen::MatrixXf
plainKernelMatrix(const Eigen::MatrixXf& positions, const Eigen::MatrixXf& features,
                  double weight, double deviation, const SemanticCRFParameters& crf)
{
  const double sigma = deviation * std::sqrt(double(TruncatedKernel::widening(
                                       float(crf.radius), crf.normalization)));
  Eigen::MatrixXd k = weight * gaussianMatrix(positions, features, sigma,
                                              deviation * crf.radius + 1e-5);
  const Eigen::VectorXd sums = k.rowwise().sum() / weight;
  if (crf.normalization == Normalization::symmetric)
    k = (sums.array().rsqrt().matrix().asDiagonal() * k *
         sums.array().rsqrt().matrix().asDiagonal())
            .eval();
  if (crf.normalization == Normalization::one_sided)
    k = (sums.array().inverse().matrix().asDiagonal() * k).eval();
  return k.cast<float>();
}

/** \brief Costs -log p, eq. (4). */
inline Eigen::MatrixXf
plainUnary(const Eigen::MatrixXf& distributions)
{
  return -distributions.array().max(1e-6f).log();
}

/** \brief The upper median. */
inline float
plainMedian(const Eigen::VectorXf& values)
{
  std::vector<float> sorted(values.data(), values.data() + values.size());
  std::sort(sorted.begin(), sorted.end());
  return sorted[sorted.size() / 2];
}

/** \brief The dense CRF over some points of a cloud. */
inline PlainCrf
makePlainCrf(const CrfCloud& input, const pcl::Indices& indices,
             const SemanticCRFParameters& parameters)
{
  const auto count = Eigen::Index(indices.size());
  Eigen::MatrixXf positions(3, count), colours(3, count), measured(4, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const pcl::PointXYZRGBL& point =
        (*input.cloud)[std::size_t(indices[std::size_t(i)])];
    positions.col(i) = point.getVector3fMap();
    colours.col(i) << float(point.r), float(point.g), float(point.b);
    measured.col(i) = input.distributions.matrix().col(indices[std::size_t(i)]);
  }
  Eigen::Vector3f middle;
  for (int axis = 0; axis < 3; ++axis)
    middle[axis] = plainMedian(positions.row(axis).transpose());
  const Eigen::VectorXf distances =
      (positions.colwise() - middle).colwise().norm().transpose();
  const SemanticCRFParameters values = parameters.resolved(
      double(pointSpacing(positions)), true, double(plainMedian(distances)));
  PlainCrf crf;
  crf.unary = plainUnary(measured);
  crf.kernels = {plainKernelMatrix(positions, {}, parameters.smoothness_weight,
                                   values.smoothness_deviation, parameters),
                 plainKernelMatrix(positions, colours / float(values.colour_deviation),
                                   parameters.appearance_weight,
                                   values.appearance_deviation, parameters)};
  crf.self_interaction = parameters.self_interaction;
  return crf;
}

} // namespace pcl_semantic
