// SPDX-License-Identifier: BSD-3-Clause
#include "plane_growth.h"

#include "plane_raster.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace pcl_semantic {

namespace {

constexpr int kMostRounds = 30; // of growing and fitting; few planes need ten

class PlaneGrower {
public:
  PlaneGrower(const SurfaceCells& cells, const PlaneLimits& limits)
      : cells_(cells), limits_(limits), cosine_(std::cos(limits.angle)),
        state_(cells.size(), State::free), visit_(cells.size(), 0)
  {}

  std::vector<GrownPlane>
  grow()
  {
    std::vector<std::int32_t> seeds;
    for (std::size_t c = 0; c < cells_.size(); ++c)
      if (!cells_[c].plane.normal.isZero())
        seeds.push_back(std::int32_t(c));
    std::stable_sort(seeds.begin(), seeds.end(), [&](std::int32_t a, std::int32_t b) {
      return cells_[std::size_t(a)].plane.curvature <
             cells_[std::size_t(b)].plane.curvature;
    });
    std::vector<GrownPlane> planes;
    for (const std::int32_t seed : seeds) {
      if (state_[std::size_t(seed)] != State::free)
        continue;
      GrownPlane plane = growFrom(seed);
      const bool is_large = isLarge(plane);
      // The cells of a small plane may join another one, but do not begin again.
      for (const std::int32_t c : plane.cells)
        state_[std::size_t(c)] = is_large ? State::taken : State::tried;
      state_[std::size_t(seed)] = is_large ? State::taken : State::tried;
      if (is_large)
        planes.push_back(std::move(plane));
    }
    return planes;
  }

  void
  merge(std::vector<GrownPlane>& planes) const
  {
    sortBySize(planes);
    for (std::size_t i = 0; i < planes.size(); ++i)
      for (std::size_t j = i + 1; j < planes.size();) {
        if (!arePartsOfOne(planes[i], planes[j])) {
          ++j;
          continue;
        }
        GrownPlane& all = planes[i];
        all.cells.insert(all.cells.end(), planes[j].cells.begin(),
                         planes[j].cells.end());
        std::sort(all.cells.begin(), all.cells.end());
        all.plane = fit(all.cells);
        planes.erase(planes.begin() + std::ptrdiff_t(j));
        j = i + 1; // the larger plane may fit others
      }
    sortBySize(planes);
  }

private:
  enum class State : char { free, tried, taken };

  static void
  sortBySize(std::vector<GrownPlane>& planes)
  {
    std::stable_sort(planes.begin(), planes.end(),
                     [](const GrownPlane& a, const GrownPlane& b) {
                       return a.cells.size() > b.cells.size();
                     });
  }

  FittedPlane
  fit(const std::vector<std::int32_t>& cells) const
  {
    if (cells.empty())
      return {};
    PlaneMoments moments(cells_[std::size_t(cells.front())].mean);
    for (const std::int32_t c : cells)
      moments.add(cells_[std::size_t(c)].mean);
    return fitPlane(moments);
  }

  bool
  isLarge(const GrownPlane& plane) const
  {
    const double square = limits_.square * limits_.square;
    if (plane.plane.normal.isZero() ||
        double(plane.cells.size()) * square < limits_.area)
      return false;
    PlaneRaster raster(plane.plane.normal, plane.plane.centre, limits_.square);
    for (const std::int32_t c : plane.cells)
      raster.add(cells_[std::size_t(c)].mean);
    return raster.area() >= limits_.area;
  }

  bool
  fits(const FittedPlane& plane, std::size_t c) const
  {
    const SurfaceCell& cell = cells_[c];
    return std::abs(cell.plane.normal.dot(plane.normal)) >= cosine_ &&
           plane.distance(cell.mean) <= limits_.distance;
  }

  // Grows with a fixed plane, fits it, and grows again from the cells that still fit.
  GrownPlane
  growFrom(std::int32_t seed)
  {
    GrownPlane grown{cells_[std::size_t(seed)].plane, {seed}};
    for (int round = 0; round < kMostRounds; ++round) {
      std::vector<std::int32_t> cells = connected(grown);
      const bool is_grown = cells.size() > grown.cells.size();
      const FittedPlane plane = fit(cells);
      if (plane.normal.isZero())
        return grown;
      grown = {plane, std::move(cells)};
      if (round > 0 && !is_grown)
        break;
    }
    return grown;
  }

  // The cells that fit and are connected with those of a plane.
  std::vector<std::int32_t>
  connected(const GrownPlane& grown)
  {
    ++visits_;
    std::vector<std::int32_t> cells;
    const auto join = [&](std::size_t c) {
      if (visit_[c] == visits_ || state_[c] == State::taken || !fits(grown.plane, c))
        return;
      visit_[c] = visits_;
      cells.push_back(std::int32_t(c));
    };
    for (const std::int32_t c : grown.cells)
      join(std::size_t(c));
    for (std::size_t next = 0; next < cells.size(); ++next)
      cells_.forEachNeighbour(std::size_t(cells[next]), join);
    std::sort(cells.begin(), cells.end());
    return cells;
  }

  bool
  arePartsOfOne(const GrownPlane& large, const GrownPlane& small) const
  {
    if (std::abs(large.plane.normal.dot(small.plane.normal)) < cosine_)
      return false;
    double sum = 0.0;
    for (const std::int32_t c : small.cells) {
      const double distance = large.plane.distance(cells_[std::size_t(c)].mean);
      sum += distance * distance;
    }
    return sum <= limits_.distance * limits_.distance * double(small.cells.size()) &&
           areNear(large, small);
  }

  // Whether two cells of the planes are within the gap. Only cells in neighbouring
  // cubes with the gap as edge are compared.
  bool
  areNear(const GrownPlane& large, const GrownPlane& small) const
  {
    using Cube = std::tuple<int, int, int>;
    const auto cubeOf = [&](std::int32_t c) {
      const Eigen::Vector3d& p = cells_[std::size_t(c)].mean;
      const auto part = [&](double x) { return int(std::floor(x / limits_.gap)); };
      return Cube(part(p.x()), part(p.y()), part(p.z()));
    };
    std::vector<std::pair<Cube, std::int32_t>> cells;
    for (const std::int32_t c : large.cells)
      cells.emplace_back(cubeOf(c), c);
    std::sort(cells.begin(), cells.end());
    const double squared = limits_.gap * limits_.gap;
    const auto isNear = [&](const Cube& cube, const Eigen::Vector3d& mean) {
      auto found = std::lower_bound(cells.begin(), cells.end(), std::pair(cube, -1));
      for (; found != cells.end() && found->first == cube; ++found)
        if ((cells_[std::size_t(found->second)].mean - mean).squaredNorm() <= squared)
          return true;
      return false;
    };
    for (const std::int32_t c : small.cells) {
      const auto [x, y, z] = cubeOf(c);
      const Eigen::Vector3d& mean = cells_[std::size_t(c)].mean;
      for (int dx = -1; dx <= 1; ++dx)
        for (int dy = -1; dy <= 1; ++dy)
          for (int dz = -1; dz <= 1; ++dz)
            if (isNear(Cube(x + dx, y + dy, z + dz), mean))
              return true;
    }
    return false;
  }

  const SurfaceCells& cells_;
  PlaneLimits limits_;
  double cosine_;
  std::vector<State> state_;
  std::vector<std::uint32_t> visit_; // last visit of each cell
  std::uint32_t visits_ = 0;
};

} // namespace

std::vector<GrownPlane>
growPlanes(const SurfaceCells& cells, const PlaneLimits& limits)
{
  PlaneGrower grower(cells, limits);
  std::vector<GrownPlane> planes = grower.grow();
  grower.merge(planes);
  return planes;
}

} // namespace pcl_semantic
