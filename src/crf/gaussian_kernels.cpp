// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/crf/gaussian_kernels.h>

#include "core/fail.h"
#include "lattice_kernel.h"
#include "requirements.h"
#include "truncated_kernel.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

namespace pcl_semantic {

namespace {

Eigen::Matrix3Xf
inSpace(const Eigen::MatrixXf& positions)
{
  Eigen::Matrix3Xf padded = Eigen::Matrix3Xf::Zero(3, positions.cols());
  padded.topRows(positions.rows()) = positions;
  return padded;
}

// Row-major, for vectorised loops.
using PointsByRow = Eigen::Matrix<float, 3, Eigen::Dynamic, Eigen::RowMajor>;

// Points within a radius of one of them, itself included.
std::size_t
countWithin(const PointsByRow& points, Eigen::Index center, float squared_radius)
{
  const Eigen::Vector3f position = points.col(center);
  unsigned count = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const float dx = points(0, i) - position.x(), dy = points(1, i) - position.y(),
                dz = points(2, i) - position.z();
    count += dx * dx + dy * dy + dz * dz <= squared_radius ? 1 : 0;
  }
  return count;
}

void
validate(const Eigen::MatrixXf& positions, const std::vector<float>& deviations,
         const GaussianKernelOptions& options)
{
  if (positions.rows() < 1 || positions.rows() > 3)
    badParameter("positions have ", positions.rows(), " coordinates, expected 1 to 3");
  requireFinite(positions, "a position is not finite");
  requirePositive(options.radius, "kernel radius");
  for (const float deviation : deviations)
    requirePositive(deviation, "position deviation");
}

} // namespace

void
GaussianTerm::validate(Eigen::Index points) const
{
  requirePositive(position_deviation, "position deviation");
  requireWeight(weight);
  if (features.size() > 0 && features.cols() != points)
    badParameter("features have ", features.cols(), " columns, expected ", points);
  requireFinite(features, "a feature is not finite");
}

GaussianKernels::GaussianKernels(const Eigen::MatrixXf& positions,
                                 const std::vector<float>& deviations,
                                 const GaussianKernelOptions& options)
    : options_(options)
{
  validate(positions, deviations, options);
  const Eigen::Matrix3Xf points = inSpace(positions);
  float widest = 0.0f; // of the truncated terms
  for (std::size_t m = 0; m < deviations.size(); ++m) {
    const float deviation = deviations[m];
    KernelMethod method = options.method;
    if (method == KernelMethod::automatic && m > 0 && deviation == deviations[m - 1])
      method = methods_[m - 1];
    else if (method == KernelMethod::automatic)
      method =
          TruncatedKernel::canHold(points, deviation) &&
                  meanNeighbours(points, options.radius * deviation) <= max_neighbours
              ? KernelMethod::truncated
              : KernelMethod::lattice;
    methods_.push_back(method);
    if (method == KernelMethod::truncated)
      widest = std::max(widest, deviation);
  }
  if (widest > 0.0f)
    order_ = TruncatedKernel::fastestOrder(points, options.radius, widest);
}

GaussianKernels::List
GaussianKernels::make(const Eigen::MatrixXf& positions,
                      const std::vector<GaussianTerm>& terms) const
{
  if (terms.size() != methods_.size())
    badParameter(terms.size(), " terms, expected ", methods_.size());
  List kernels;
  // Grouped by deviation, because a kernel is widened to compensate its radius.
  std::map<float, std::vector<GaussianTerm>> truncated;
  for (std::size_t m = 0; m < terms.size(); ++m) {
    const GaussianTerm& term = terms[m];
    if (term.weight == 0.0f)
      continue;
    if (methods_[m] == KernelMethod::truncated) {
      truncated[term.position_deviation].push_back(term);
      continue;
    }
    Eigen::MatrixXf features(positions.rows() + term.features.rows(), positions.cols());
    features.topRows(positions.rows()) = positions / term.position_deviation;
    if (term.features.size() > 0)
      features.bottomRows(term.features.rows()) = term.features;
    kernels.push_back(
        std::make_shared<LatticeKernel>(features, term.weight, options_.normalization));
  }
  for (const auto& [deviation, group] : truncated)
    kernels.push_back(std::make_shared<TruncatedKernel>(
        inSpace(positions), group, options_.radius, options_.normalization));
  return kernels;
}

double
GaussianKernels::meanNeighbours(const Eigen::Matrix3Xf& positions, float reach)
{
  constexpr Eigen::Index samples = 64, max_others = 8192;
  const Eigen::Index count = positions.cols();
  if (count == 0)
    return 0.0;
  // All points or a random sample: a regular sample would align with the rows of an
  // image.
  PointsByRow others(3, std::min(count, max_others));
  std::minstd_rand random;
  for (Eigen::Index i = 0; i < others.cols(); ++i)
    others.col(i) =
        positions.col(count > max_others ? Eigen::Index(random()) % count : i);
  const Eigen::Index step = std::max<Eigen::Index>(1, others.cols() / samples);
  std::size_t found = 0, sampled = 0;
  for (Eigen::Index i = 0; i < others.cols(); i += step, ++sampled)
    found += countWithin(others, i, reach * reach);
  // The point itself counts once; the other neighbours are extrapolated from the
  // sample.
  return 1.0 + double(found - sampled) / double(sampled) * double(count) /
                   double(others.cols());
}

} // namespace pcl_semantic
