// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/crf/gaussian_kernels.h>

#include "core/fail.h"
#include "core/point_spacing.h"
#include "lattice_kernel.h"
#include "requirements.h"
#include "truncated_kernel.h"

#include <algorithm>
#include <cmath>
#include <map>

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

// \param[in] density see GaussianKernels::choose()
std::vector<KernelMethod>
methodsFor(const Eigen::MatrixXf& positions, const std::vector<float>& deviations,
           const GaussianKernelOptions& options, double density)
{
  validate(positions, deviations, options);
  const Eigen::Matrix3Xf points = inSpace(positions);
  const auto hasFewNeighbours = [&](float deviation) {
    const double others =
        GaussianKernels::meanNeighbours(points, options.radius * deviation) - 1.0;
    return 1.0 + others * density <= GaussianKernels::max_neighbours;
  };
  std::vector<KernelMethod> methods;
  for (std::size_t m = 0; m < deviations.size(); ++m) {
    const float deviation = deviations[m];
    KernelMethod method = options.method;
    if (method == KernelMethod::automatic && m > 0 && deviation == deviations[m - 1])
      method = methods[m - 1];
    else if (method == KernelMethod::automatic)
      method =
          hasFewNeighbours(deviation) ? KernelMethod::truncated : KernelMethod::lattice;
    methods.push_back(method);
  }
  return methods;
}

// Terms of wide clouds have lattices, if the method is automatic.
void
holdAll(const Eigen::MatrixXf& positions, const std::vector<float>& deviations,
        const GaussianKernelOptions& options, std::vector<KernelMethod>& methods)
{
  if (options.method != KernelMethod::automatic)
    return;
  const Eigen::Matrix3Xf points = inSpace(positions);
  for (std::size_t m = 0; m < methods.size(); ++m)
    if (!TruncatedKernel::canHold(points, deviations[m]))
      methods[m] = KernelMethod::lattice;
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

GaussianKernels::Choice
GaussianKernels::choose(const Eigen::MatrixXf& positions,
                        const std::vector<GaussianTerm>& terms,
                        const GaussianKernelOptions& options, double density)
{
  std::vector<float> deviations;
  for (const GaussianTerm& term : terms)
    deviations.push_back(term.position_deviation);
  Choice choice;
  choice.methods = methodsFor(positions, deviations, options, density);
  for (const GaussianTerm& term : terms) {
    Eigen::VectorXf lows =
        Eigen::VectorXf::Zero(positions.rows() + term.features.rows());
    if (positions.cols() > 0)
      lows.head(positions.rows()) =
          (positions / term.position_deviation).rowwise().minCoeff();
    if (term.features.size() > 0)
      lows.tail(term.features.rows()) = term.features.rowwise().minCoeff();
    choice.lows.push_back(std::move(lows));
  }
  return choice;
}

GaussianKernels::GaussianKernels(const Eigen::MatrixXf& positions,
                                 const std::vector<float>& deviations,
                                 const GaussianKernelOptions& options)
    : GaussianKernels(positions, deviations, options,
                      Choice{methodsFor(positions, deviations, options, 1.0), {}})
{}

GaussianKernels::GaussianKernels(const Eigen::MatrixXf& positions,
                                 const std::vector<float>& deviations,
                                 const GaussianKernelOptions& options, Choice choice)
    : options_(options), choice_(std::move(choice))
{
  if (choice_.methods.size() != deviations.size())
    badParameter(choice_.methods.size(), " methods of kernels, expected ",
                 deviations.size());
  holdAll(positions, deviations, options, choice_.methods);
  float widest = 0.0f; // of the truncated terms
  for (std::size_t m = 0; m < deviations.size(); ++m)
    if (choice_.methods[m] == KernelMethod::truncated)
      widest = std::max(widest, deviations[m]);
  if (widest > 0.0f)
    order_ = TruncatedKernel::fastestOrder(inSpace(positions), options.radius, widest);
}

GaussianKernels::List
GaussianKernels::make(const Eigen::MatrixXf& positions,
                      const std::vector<GaussianTerm>& terms,
                      const std::function<void()>& before) const
{
  if (terms.size() != choice_.methods.size())
    badParameter(terms.size(), " terms, expected ", choice_.methods.size());
  List kernels;
  // Grouped by deviation, because a kernel is widened to compensate its radius.
  std::map<float, std::vector<GaussianTerm>> truncated;
  for (std::size_t m = 0; m < terms.size(); ++m) {
    const GaussianTerm& term = terms[m];
    if (term.weight == 0.0f)
      continue;
    if (choice_.methods[m] == KernelMethod::truncated) {
      truncated[term.position_deviation].push_back(term);
      continue;
    }
    if (before)
      before();
    Eigen::MatrixXf features(positions.rows() + term.features.rows(), positions.cols());
    features.topRows(positions.rows()) = positions / term.position_deviation;
    if (term.features.size() > 0)
      features.bottomRows(term.features.rows()) = term.features;
    kernels.push_back(std::make_shared<LatticeKernel>(
        features, term.weight, options_.normalization, simdTier(),
        choice_.lows.empty() ? Eigen::VectorXf() : choice_.lows[m]));
  }
  for (const auto& [deviation, group] : truncated) {
    if (before)
      before();
    kernels.push_back(std::make_shared<TruncatedKernel>(
        inSpace(positions), group, options_.radius, options_.normalization));
  }
  return kernels;
}

double
GaussianKernels::meanNeighbours(const Eigen::Matrix3Xf& positions, float reach)
{
  constexpr Eigen::Index samples = 64;
  const Eigen::Index count = positions.cols();
  if (count == 0)
    return 0.0;
  PointsByRow others = positions;
  if (count > Eigen::Index(max_sample)) {
    const std::vector<Eigen::Index> sample = sampleByPosition(positions, max_sample);
    others.resize(3, Eigen::Index(sample.size()));
    for (Eigen::Index i = 0; i < others.cols(); ++i)
      others.col(i) = positions.col(sample[std::size_t(i)]);
  }
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
