/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/neighbour_search.h>
#include <pcl_semantic/crf/truncated_kernel.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

void
validate(const Eigen::Matrix3Xf& positions, const std::vector<GaussianTerm>& terms,
         float radius)
{
  if (!(radius > 0.0f) || !std::isfinite(radius))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "kernel radius is " << radius << ", expected more than 0");
  if (!positions.allFinite())
    PCL_THROW_EXCEPTION(InvalidParameterException, "a position is not finite");
  for (const GaussianTerm& term : terms) {
    if (!(term.position_deviation > 0.0f) || !std::isfinite(term.position_deviation))
      PCL_THROW_EXCEPTION(InvalidParameterException, "position deviation is "
                                                         << term.position_deviation
                                                         << ", expected more than 0");
    if (!(term.weight >= 0.0f) || !std::isfinite(term.weight))
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "kernel weight is " << term.weight << ", expected 0 or more");
    if (term.features.size() > 0 && term.features.cols() != positions.cols())
      PCL_THROW_EXCEPTION(InvalidParameterException, "features have "
                                                         << term.features.cols()
                                                         << " columns, expected "
                                                         << positions.cols());
    if (!term.features.allFinite())
      PCL_THROW_EXCEPTION(InvalidParameterException, "a feature is not finite");
  }
}

float
gaussian(const GaussianTerm& term, float squared_distance, Eigen::Index i,
         Eigen::Index j)
{
  float exponent =
      squared_distance / (term.position_deviation * term.position_deviation);
  if (term.features.size() > 0)
    exponent += (term.features.col(i) - term.features.col(j)).squaredNorm();
  return std::exp(-0.5f * exponent);
}

} // namespace

TruncatedKernel::TruncatedKernel(const Eigen::Matrix3Xf& positions,
                                 const std::vector<GaussianTerm>& terms, float radius)
{
  validate(positions, terms, radius);
  float widest = 0.0f;
  for (const GaussianTerm& term : terms)
    widest = std::max(widest, term.position_deviation);
  if (terms.empty()) {
    starts_.assign(std::size_t(positions.cols()) + 1, 0);
    diagonal_ = Eigen::VectorXf::Zero(positions.cols());
    return;
  }
  NeighbourLists lists = findNeighbours(positions, radius * widest);
  starts_ = std::move(lists.starts);
  neighbours_ = std::move(lists.neighbours);
  setWeights(positions, terms);
}

void
TruncatedKernel::setWeights(const Eigen::Matrix3Xf& positions,
                            const std::vector<GaussianTerm>& terms)
{
  weights_.assign(neighbours_.size(), 0.0f);
  diagonal_ = Eigen::VectorXf::Zero(size());
  std::vector<float> kernel(neighbours_.size());
  Eigen::VectorXf scale(size()); // w^1/2 D^-1/2
  for (const GaussianTerm& term : terms) {
#pragma omp parallel for schedule(dynamic, 1024)
    for (Eigen::Index i = 0; i < size(); ++i) {
      float sum = 1.0f; // k_ii
      for (std::size_t e = starts_[i]; e < starts_[i + 1]; ++e) {
        const std::int32_t j = neighbours_[e];
        const float squared = (positions.col(i) - positions.col(j)).squaredNorm();
        kernel[e] = gaussian(term, squared, i, j);
        sum += kernel[e];
      }
      scale[i] = std::sqrt(term.weight / sum);
      diagonal_[i] += term.weight / sum;
    }
#pragma omp parallel for schedule(dynamic, 1024)
    for (Eigen::Index i = 0; i < size(); ++i)
      for (std::size_t e = starts_[i]; e < starts_[i + 1]; ++e)
        weights_[e] += kernel[e] * scale[i] * scale[neighbours_[e]];
  }
}

void
TruncatedKernel::addProduct(const Eigen::Ref<const Eigen::MatrixXf>& values,
                            Eigen::Ref<Eigen::MatrixXf> result,
                            const VariableMask& active) const
{
  const Eigen::Index rows = values.rows();
#pragma omp parallel for schedule(dynamic, 512)
  for (Eigen::Index i = 0; i < size(); ++i) {
    if (!active.empty() && !active[std::size_t(i)])
      continue;
    float* const sum = result.col(i).data();
    for (std::size_t e = starts_[i]; e < starts_[i + 1]; ++e) {
      const float weight = weights_[e];
      const float* const value = values.col(neighbours_[e]).data();
      for (Eigen::Index k = 0; k < rows; ++k)
        sum[k] += weight * value[k];
    }
  }
}

} // namespace pcl_semantic
