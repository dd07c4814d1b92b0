// SPDX-License-Identifier: BSD-3-Clause
#include "surface_cells.h"

#include "core/fail.h"
#include "core/parallel_guard.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace pcl_semantic {

namespace {

constexpr int kReach = 2;           // cubes that the radius spans
constexpr unsigned kBits = 21;      // of a coordinate of a cube, with room for kReach
constexpr std::size_t kPart = 4096; // cells that one thread takes at once

// Of points on a line, the second eigenvalue is at most this part of the largest, by
// rounding.
constexpr double kOnLine = 1e-9;

// Of a surface around a point, the second eigenvalue is at least kLeastWidth of the
// largest, and the least one at most kMostThickness of the second.
constexpr double kLeastWidth = 1.0 / 16.0, kMostThickness = 0.25;

// The least root of x^3 - x^2 + b x - c, for the eigenvalues of a positive semidefinite
// matrix of trace 1. Newton's method approaches it from below.
double
leastEigenvalue(double b, double c)
{
  double x = 0.0;
  for (int i = 0; i < 32; ++i) {
    const double value = ((x - 1.0) * x + b) * x - c;
    const double slope = (3.0 * x - 2.0) * x + b;
    if (!(value < 0.0 && slope > 0.0))
      break;
    const double step = -value / slope;
    x += step;
    if (step <= 1e-15)
      break;
  }
  return x;
}

Eigen::Vector3d
withPositiveLargest(const Eigen::Vector3d& vector)
{
  Eigen::Index largest;
  vector.cwiseAbs().maxCoeff(&largest);
  return vector[largest] < 0.0 ? -vector : vector;
}

// Numbers the cubes along an axis. If the points are too far apart for a key, wide gaps
// become narrow: cubes within kReach keep their distance, and others stay further
// apart.
class AxisNumbers {
public:
  AxisNumbers(const std::vector<Eigen::Vector3d>& points, int axis, double edge,
              double radius)
  {
    double last = -HUGE_VAL;
    first_ = HUGE_VAL;
    for (const Eigen::Vector3d& point : points) {
      const double cube = std::floor(point[axis] / edge);
      first_ = std::min(first_, cube);
      last = std::max(last, cube);
    }
    if (last - first_ < most)
      return;
    for (const Eigen::Vector3d& point : points)
      cubes_.push_back(std::floor(point[axis] / edge));
    std::sort(cubes_.begin(), cubes_.end());
    cubes_.erase(std::unique(cubes_.begin(), cubes_.end()), cubes_.end());
    std::uint64_t number = kReach;
    for (std::size_t i = 0; i < cubes_.size(); ++i) {
      if (i > 0)
        number += std::uint64_t(std::min(cubes_[i] - cubes_[i - 1], kReach + 1.0));
      numbers_.push_back(number);
    }
    if (double(number) >= most)
      badInput("planes extend over ", number, " cubes, expected less than ",
               std::uint64_t(most), " for a radius of ", radius, " m");
  }

  std::uint64_t
  operator[](double cube) const
  {
    if (cubes_.empty())
      return std::uint64_t(cube - first_) + kReach;
    return numbers_[std::size_t(std::lower_bound(cubes_.begin(), cubes_.end(), cube) -
                                cubes_.begin())];
  }

private:
  static constexpr double most = (1u << kBits) - 2.0 * kReach; // cubes

  double first_ = 0.0;
  std::vector<double> cubes_; // empty: the numbers are those of the cubes
  std::vector<std::uint64_t> numbers_;
};

} // namespace

std::array<double, 6>
PlaneMoments::covariance() const
{
  const double n = double(count_);
  const Eigen::Vector3d m = sum_ / n;
  return {squares_[0] / n - m.x() * m.x(), squares_[1] / n - m.x() * m.y(),
          squares_[2] / n - m.x() * m.z(), squares_[3] / n - m.y() * m.y(),
          squares_[4] / n - m.y() * m.z(), squares_[5] / n - m.z() * m.z()};
}

FittedPlane
fitPlane(const PlaneMoments& moments)
{
  FittedPlane plane;
  if (moments.count() < 3)
    return plane;
  plane.centre = moments.mean();
  std::array<double, 6> a = moments.covariance();
  const double trace = a[0] + a[3] + a[5];
  if (!(trace > 0.0))
    return plane;
  for (double& each : a)
    each /= trace;
  const auto [xx, xy, xz, yy, yz, zz] = a;
  const double b = (xx * yy - xy * xy) + (xx * zz - xz * xz) + (yy * zz - yz * yz);
  const double c =
      xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
  const double least = leastEigenvalue(b, c);
  plane.curvature = least;
  plane.deviation = std::sqrt(least * trace);
  // The others have the sum 1 - least and the product b - least (1 - least).
  const double sum = 1.0 - least, product = b - least * sum;
  const double second =
      0.5 * (sum - std::sqrt(std::max(0.0, sum * sum - 4.0 * product)));
  if (!(second > kOnLine * sum))
    return plane;
  plane.is_surface =
      second >= kLeastWidth * (sum - second) && least <= kMostThickness * second;
  const Eigen::Vector3d x(xx - least, xy, xz), y(xy, yy - least, yz),
      z(xz, yz, zz - least);
  Eigen::Vector3d normal = x.cross(y);
  for (const Eigen::Vector3d& each : {y.cross(z), z.cross(x)})
    if (each.squaredNorm() > normal.squaredNorm())
      normal = each;
  if (!(normal.squaredNorm() > 0.0)) // two least eigenvalues: a line
    return plane;
  plane.normal = withPositiveLargest(normal / std::sqrt(normal.squaredNorm()));
  return plane;
}

SurfaceCells::SurfaceCells(const std::vector<Eigen::Vector3d>& points, double radius)
    : radius_(radius)
{
  sort(points);
  findNeighbours();
  fitPlanes();
}

void
SurfaceCells::sort(const std::vector<Eigen::Vector3d>& points)
{
  const double edge = radius_ / kReach;
  // A grid of the cloud's frame: a distant point does not move the others' cubes.
  const std::array<AxisNumbers, 3> axes{AxisNumbers(points, 0, edge, radius_),
                                        AxisNumbers(points, 1, edge, radius_),
                                        AxisNumbers(points, 2, edge, radius_)};
  std::vector<std::pair<Key, std::size_t>> keyed(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d cube = (points[i] / edge).array().floor();
    keyed[i] = {axes[2][cube.z()] << 2 * kBits | axes[1][cube.y()] << kBits |
                    axes[0][cube.x()],
                i};
  }
  const auto isBefore = [&](const auto& a, const auto& b) {
    if (a.first != b.first)
      return a.first < b.first;
    const Eigen::Vector3d &p = points[a.second], &q = points[b.second];
    return std::make_tuple(p.z(), p.y(), p.x(), a.second) <
           std::make_tuple(q.z(), q.y(), q.x(), b.second);
  };
  std::sort(keyed.begin(), keyed.end(), isBefore);
  order_.reserve(points.size());
  for (const auto& [key, i] : keyed) {
    if (keys_.empty() || keys_.back() != key) {
      keys_.push_back(key);
      cells_.emplace_back();
      cells_.back().first = order_.size();
    }
    order_.push_back(i);
    cells_.back().last = order_.size();
    cells_.back().mean += points[i];
  }
  for (SurfaceCell& cell : cells_)
    cell.mean /= double(cell.last - cell.first);
}

void
SurfaceCells::findNeighbours()
{
  const std::size_t parts = (size() + kPart - 1) / kPart;
  std::vector<std::vector<std::int32_t>> found(parts);
  starts_.assign(size() + 1, 0);
  const double squared = radius_ * radius_;
  ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t part = 0; part < parts; ++part)
    guard.run([&] {
      constexpr int rows = (2 * kReach + 1) * (2 * kReach + 1);
      // The first cell that each row of cubes around the cell may have. It moves
      // forward only, because the cells are sorted.
      std::array<std::size_t, rows> from{};
      const std::size_t begin = part * kPart, end = std::min(size(), begin + kPart);
      for (std::size_t c = begin; c < end; ++c) {
        const std::size_t before = found[part].size();
        for (int row = 0; row < rows; ++row) {
          const Key offset =
              Key(std::int64_t(row / (2 * kReach + 1) - kReach) * (1LL << 2 * kBits) +
                  std::int64_t(row % (2 * kReach + 1) - kReach) * (1LL << kBits));
          const Key lowest = keys_[c] + offset - kReach, highest = lowest + 2 * kReach;
          std::size_t& i = from[std::size_t(row)];
          if (c == begin)
            i = std::size_t(std::lower_bound(keys_.begin(), keys_.end(), lowest) -
                            keys_.begin());
          while (i < size() && keys_[i] < lowest)
            ++i;
          for (std::size_t j = i; j < size() && keys_[j] <= highest; ++j)
            if (j != c && (cells_[j].mean - cells_[c].mean).squaredNorm() <= squared)
              found[part].push_back(std::int32_t(j));
        }
        starts_[c + 1] = found[part].size() - before;
      }
    });
  guard.rethrow();
  for (std::size_t c = 0; c < size(); ++c)
    starts_[c + 1] += starts_[c];
  neighbours_.reserve(starts_.back());
  for (const std::vector<std::int32_t>& each : found)
    neighbours_.insert(neighbours_.end(), each.begin(), each.end());
}

double
SurfaceCells::deviation() const
{
  std::vector<double> deviations;
  for (const SurfaceCell& cell : cells_)
    if (!cell.plane.normal.isZero())
      deviations.push_back(cell.plane.deviation);
  if (deviations.empty())
    return 0.0;
  const auto quartile = deviations.begin() + std::ptrdiff_t(deviations.size() * 3 / 4);
  std::nth_element(deviations.begin(), quartile, deviations.end());
  return *quartile;
}

void
SurfaceCells::fitPlanes()
{
#pragma omp parallel for schedule(static)
  for (std::size_t c = 0; c < size(); ++c) {
    PlaneMoments moments(cells_[c].mean);
    moments.add(cells_[c].mean);
    forEachNeighbour(c, [&](std::size_t other) { moments.add(cells_[other].mean); });
    cells_[c].plane = fitPlane(moments);
    if (!cells_[c].plane.is_surface)
      cells_[c].plane.normal.setZero();
  }
}

} // namespace pcl_semantic
