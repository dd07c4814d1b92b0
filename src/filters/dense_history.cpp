// SPDX-License-Identifier: BSD-3-Clause
#include "dense_history.h"

#include "unary_costs.h"

#include <pcl_semantic/crf/mean_field.h>
#include <pcl_semantic/crf/truncated_kernel.h>
#include <pcl_semantic/filters/changed_region.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

namespace pcl_semantic {

namespace {

using Numbers = std::vector<std::int32_t>;

// The kernel over some points and one update of the model with it.
struct OneUpdate {
  OneUpdate(const DenseProblem& problem, const Numbers& points,
            const Eigen::Matrix3Xf& positions, const std::vector<GaussianTerm>& terms,
            const Eigen::MatrixXf& known_sums)
  {
    const auto kernel = std::make_shared<TruncatedKernel>(
        positions, terms, problem.radius, problem.normalization, known_sums);
    CrfModel model;
    model.unary = unaryCosts(problem.measured, points);
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

bool
equalColumns(const Eigen::MatrixXf& a, Eigen::Index i, const Eigen::MatrixXf& b,
             Eigen::Index j)
{
  return a.rows() == b.rows() &&
         std::memcmp(a.data() + i * a.rows(), b.data() + j * b.rows(),
                     std::size_t(a.rows()) * sizeof(float)) == 0;
}

// For each point the one in the same place of another cloud, or -1. Both are sorted by
// z, y and x if they lie on a grid; of others some may not be found, which costs time
// only.
Numbers
findSame(const DenseHistory::Places& places, const DenseHistory::Places& others)
{
  Numbers same(places.size(), -1);
  std::size_t j = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    while (j < others.size() && others[j] < places[i])
      ++j;
    if (j < others.size() && others[j] == places[i])
      same[i] = std::int32_t(j++);
  }
  return same;
}

} // namespace

std::shared_ptr<const DenseHistory>
DenseHistory::update(DenseProblem&& problem, const DenseHistory* before)
{
  auto result = std::make_shared<DenseHistory>();
  result->findPlaces(problem);
  if (!before || !result->computeChanges(problem, *before))
    result->computeAll(problem);
  result->colours_ = std::move(problem.colours);
  result->measured_ = std::move(problem.measured);
  return result;
}

void
DenseHistory::computeAll(const DenseProblem& problem)
{
  Numbers points(places_.size());
  std::iota(points.begin(), points.end(), 0);
  OneUpdate all(problem, points, problem.positions, problem.terms, {});
  marginals_ = std::move(all.marginals);
  sums_ = std::move(all.sums);
  last_change_ = all.change;
}

// Numbers of places a thousandth of the radius apart: equal for the same place,
// whatever the origin is.
void
DenseHistory::findPlaces(const DenseProblem& problem)
{
  radius_ = problem.radius * problem.terms[0].position_deviation;
  places_.resize(std::size_t(problem.positions.cols()));
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < places_.size(); ++i)
    for (int a = 0; a < 3; ++a) // z first
      places_[i][std::size_t(2 - a)] = std::llround(
          (double(problem.positions(a, Eigen::Index(i))) + problem.origin[a]) / step());
}

// Positions of points that are no longer there, for another origin.
Eigen::Matrix3Xf
DenseHistory::findGone(const Numbers& same, const Eigen::Vector3d& origin) const
{
  std::vector<std::uint8_t> is_there(places_.size(), 0);
  for (const std::int32_t j : same)
    if (j >= 0)
      is_there[std::size_t(j)] = 1;
  std::vector<Eigen::Vector3f> gone;
  for (std::size_t j = 0; j < is_there.size(); ++j)
    if (!is_there[j])
      gone.push_back((Eigen::Vector3d(double(places_[j][2]), double(places_[j][1]),
                                      double(places_[j][0])) *
                          step() -
                      origin)
                         .cast<float>());
  return Eigen::Map<const Eigen::Matrix3Xf>(gone.empty() ? nullptr : gone[0].data(), 3,
                                            Eigen::Index(gone.size()));
}

// False if that would be no quicker.
bool
DenseHistory::computeChanges(const DenseProblem& problem, const DenseHistory& before)
{
  if (problem.measured.rows() != before.measured_.rows())
    return false;
  const Eigen::Matrix3Xf& positions = problem.positions;
  const Numbers same = findSame(places_, before.places_);
  std::vector<std::uint8_t> changed(same.size());
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < same.size(); ++i)
    changed[i] =
        same[i] < 0 ||
        !equalColumns(problem.colours, Eigen::Index(i), before.colours_, same[i]) ||
        !equalColumns(problem.measured, Eigen::Index(i), before.measured_, same[i]);
  const ChangedRegion region = findChangedRegion(
      positions, changed, before.findGone(same, problem.origin), radius_);
  if (2 * region.points.size() > same.size())
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
      known.col(Eigen::Index(k)) = before.sums_.col(same[std::size_t(points[k])]);
  const OneUpdate part(problem, points, positions(Eigen::all, points), terms, known);

  marginals_.resize(problem.measured.rows(), positions.cols());
  sums_.resize(known.rows(), positions.cols());
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < same.size(); ++i)
    if (same[i] >= 0) {
      marginals_.col(Eigen::Index(i)) = before.marginals_.col(same[i]);
      sums_.col(Eigen::Index(i)) = before.sums_.col(same[i]);
    }
  taken_over_ = same.size();
  for (std::size_t k = 0; k < points.size(); ++k) {
    sums_.col(points[k]) = part.sums.col(Eigen::Index(k));
    taken_over_ -= region.result[k] ? 1 : 0;
    if (region.result[k])
      marginals_.col(points[k]) = part.marginals.col(Eigen::Index(k));
  }
  last_change_ = part.change;
  return true;
}

} // namespace pcl_semantic
