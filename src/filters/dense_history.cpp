/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "dense_history.h"

#include "unary_costs.h"

#include <pcl_semantic/crf/mean_field.h>
#include <pcl_semantic/crf/truncated_kernel.h>
#include <pcl_semantic/filters/changed_region.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace pcl_semantic {

namespace {

using Numbers = std::vector<std::int32_t>;

// The kernel over some points and one update of the model with it.
struct OneUpdate {
  OneUpdate(const DenseProblem& problem, const Eigen::Matrix3Xf& positions,
            const std::vector<GaussianTerm>& terms, const Eigen::MatrixXf& measured,
            const Eigen::MatrixXf& known_sums)
  {
    const auto kernel = std::make_shared<TruncatedKernel>(
        positions, terms, problem.radius, problem.normalization, known_sums);
    CrfModel model;
    model.unary = unaryCosts(measured);
    model.kernels = {kernel};
    model.compatibility = problem.compatibility;
    model.self_interaction = problem.self_interaction;
    MeanField inference(std::move(model));
    change = inference.update();
    marginals = inference.marginals();
    sums = kernel->sums();
  }

  double change;
  Eigen::MatrixXf marginals;
  Eigen::MatrixXf sums;
};

// Order of points on a grid: z, then y, then x.
bool
isBefore(const Eigen::Vector3f& a, const Eigen::Vector3f& b)
{
  if (a.z() != b.z())
    return a.z() < b.z();
  if (a.y() != b.y())
    return a.y() < b.y();
  return a.x() < b.x();
}

bool
equalColumns(const Eigen::MatrixXf& a, Eigen::Index i, const Eigen::MatrixXf& b,
             Eigen::Index j)
{
  return a.rows() == b.rows() &&
         std::memcmp(a.data() + i * a.rows(), b.data() + j * b.rows(),
                     std::size_t(a.rows()) * sizeof(float)) == 0;
}

// For each point the one in the same place of another cloud, or -1. Both are sorted if
// they lie on a grid; of others some may not be found, which costs time only.
Numbers
findPlaces(const Eigen::Matrix3Xf& positions, const Eigen::Matrix3Xf& others)
{
  Numbers places(std::size_t(positions.cols()), -1);
  Eigen::Index j = 0;
  for (Eigen::Index i = 0; i < positions.cols(); ++i) {
    while (j < others.cols() && isBefore(others.col(j), positions.col(i)))
      ++j;
    if (j < others.cols() && others.col(j) == positions.col(i))
      places[std::size_t(i)] = std::int32_t(j++);
  }
  return places;
}

// The points that have no place any more.
Eigen::Matrix3Xf
findGone(const Eigen::Matrix3Xf& others, const Numbers& places)
{
  std::vector<std::uint8_t> is_there(std::size_t(others.cols()), 0);
  for (const std::int32_t j : places)
    if (j >= 0)
      is_there[std::size_t(j)] = 1;
  Numbers gone;
  for (std::size_t j = 0; j < is_there.size(); ++j)
    if (!is_there[j])
      gone.push_back(std::int32_t(j));
  return others(Eigen::all, gone);
}

} // namespace

std::shared_ptr<const DenseHistory>
DenseHistory::update(DenseProblem&& problem, const DenseHistory* before)
{
  auto result = std::make_shared<DenseHistory>();
  if (!before || !result->computeChanges(problem, *before))
    result->computeAll(problem);
  result->origin_ = problem.origin;
  result->positions_ = std::move(problem.positions);
  result->colours_ = std::move(problem.colours);
  result->measured_ = std::move(problem.measured);
  return result;
}

void
DenseHistory::computeAll(const DenseProblem& problem)
{
  OneUpdate all(problem, problem.positions, problem.terms, problem.measured, {});
  marginals_ = std::move(all.marginals);
  sums_ = std::move(all.sums);
  last_change_ = all.change;
}

// False if that would be no quicker.
bool
DenseHistory::computeChanges(const DenseProblem& problem, const DenseHistory& before)
{
  if (problem.origin != before.origin_ ||
      problem.measured.rows() != before.measured_.rows())
    return false;
  const Eigen::Matrix3Xf& positions = problem.positions;
  const Numbers places = findPlaces(positions, before.positions_);
  std::vector<std::uint8_t> changed(places.size());
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < places.size(); ++i)
    changed[i] =
        places[i] < 0 ||
        !equalColumns(problem.colours, Eigen::Index(i), before.colours_, places[i]) ||
        !equalColumns(problem.measured, Eigen::Index(i), before.measured_, places[i]);
  float widest = 0.0f;
  for (const GaussianTerm& term : problem.terms)
    widest = std::max(widest, term.position_deviation);
  const ChangedRegion region =
      findChangedRegion(positions, changed, findGone(before.positions_, places),
                        problem.radius * widest);
  if (2 * region.points.size() > places.size())
    return false;

  const Numbers& points = region.points;
  std::vector<GaussianTerm> terms = problem.terms;
  for (GaussianTerm& term : terms)
    if (term.features.size() > 0)
      term.features = term.features(Eigen::all, points).eval();
  Eigen::MatrixXf known(Eigen::Index(terms.size()), Eigen::Index(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k)
    if (region.fresh[k])
      known.col(Eigen::Index(k)).setConstant(std::nanf(""));
    else
      known.col(Eigen::Index(k)) = before.sums_.col(places[std::size_t(points[k])]);
  const OneUpdate part(problem, positions(Eigen::all, points), terms,
                       problem.measured(Eigen::all, points), known);

  marginals_.resize(problem.measured.rows(), positions.cols());
  sums_.resize(known.rows(), positions.cols());
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < places.size(); ++i)
    if (places[i] >= 0) {
      marginals_.col(Eigen::Index(i)) = before.marginals_.col(places[i]);
      sums_.col(Eigen::Index(i)) = before.sums_.col(places[i]);
    }
  for (std::size_t k = 0; k < points.size(); ++k) {
    sums_.col(points[k]) = part.sums.col(Eigen::Index(k));
    if (region.result[k])
      marginals_.col(points[k]) = part.marginals.col(Eigen::Index(k));
  }
  last_change_ = part.change;
  return true;
}

} // namespace pcl_semantic
