// SPDX-License-Identifier: BSD-3-Clause
#include "plane_growth.h"

#include "plane_raster.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace pcl_semantic {

namespace {

constexpr int kMostRounds = 30; // of growing and fitting; few planes need ten

class PlaneGrower {
public:
  PlaneGrower(const SurfaceCells& cells, const PlaneLimits& limits)
      : cells_(cells), limits_(limits), cosine_(std::cos(limits.angle)),
        tries_(cells.size(), 0), visit_(cells.size(), 0)
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
      if (tries_[std::size_t(seed)] > 0)
        continue;
      GrownPlane plane = growFrom(seed);
      const bool is_large = isLarge(plane);
      // The cells of a small plane may join another one, but do not begin again.
      for (const std::int32_t c : plane.cells)
        tries_[std::size_t(c)] =
            is_large ? most_tries : std::uint8_t(tries_[std::size_t(c)] + 1);
      if (tries_[std::size_t(seed)] == 0) // the plane turned away from its seed
        tries_[std::size_t(seed)] = 1;
      if (is_large)
        planes.push_back(std::move(plane));
    }
    return planes;
  }

  std::vector<GrownPlane>
  merged(std::vector<GrownPlane> planes) const
  {
    sortBySize(planes);
    std::vector<Part> parts;
    for (GrownPlane& plane : planes)
      parts.push_back(partOf(std::move(plane)));
    for (std::size_t i = 0; i < parts.size(); ++i)
      for (std::size_t j = i + 1; j < parts.size();) {
        if (!arePartsOfOne(parts[i], parts[j])) {
          ++j;
          continue;
        }
        join(parts[j], parts[i]);
        parts.erase(parts.begin() + std::ptrdiff_t(j));
        j = i + 1; // the larger plane may fit others
      }
    planes.clear();
    for (Part& part : parts)
      planes.push_back(std::move(part.plane));
    sortBySize(planes);
    return planes;
  }

private:
  using Cube = std::array<double, 3>; // whole numbers

  // A plane while parts are merged.
  struct Part {
    GrownPlane plane;
    PlaneMoments moments;
    Eigen::AlignedBox3d box;                          // of the cells' means
    std::vector<std::pair<Cube, std::int32_t>> cells; // by cube with the gap as edge
  };

  // Refused planes that a cell may be in: without a limit, each leftover seed would
  // grow the same plane again.
  static constexpr std::uint8_t most_tries = 4;

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
      if (visit_[c] == visits_ || tries_[c] >= most_tries || !fits(grown.plane, c))
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

  Part
  partOf(GrownPlane plane) const
  {
    const Eigen::Vector3d centre = plane.plane.centre;
    Part part{std::move(plane), PlaneMoments(centre), {}, {}};
    for (const std::int32_t c : part.plane.cells) {
      const Eigen::Vector3d& mean = cells_[std::size_t(c)].mean;
      part.moments.add(mean);
      part.box.extend(mean);
      part.cells.emplace_back(cubeOf(mean), c);
    }
    std::sort(part.cells.begin(), part.cells.end());
    return part;
  }

  void
  join(const Part& small, Part& large) const
  {
    const auto append = [](const auto& from, auto& to) {
      const auto middle = std::ptrdiff_t(to.size());
      to.insert(to.end(), from.begin(), from.end());
      std::inplace_merge(to.begin(), to.begin() + middle, to.end());
    };
    append(small.plane.cells, large.plane.cells);
    append(small.cells, large.cells);
    for (const std::int32_t c : small.plane.cells)
      large.moments.add(cells_[std::size_t(c)].mean);
    large.box.extend(small.box);
    if (const FittedPlane plane = fitPlane(large.moments); !plane.normal.isZero())
      large.plane.plane = plane;
  }

  bool
  arePartsOfOne(const Part& large, const Part& small) const
  {
    const FittedPlane& plane = large.plane.plane;
    if (std::abs(plane.normal.dot(small.plane.plane.normal)) < cosine_)
      return false;
    // Mean square of the distances of the small plane's cells.
    const auto [xx, xy, xz, yy, yz, zz] = small.moments.covariance();
    Eigen::Matrix3d covariance;
    covariance << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    const double distance = plane.distance(small.moments.mean());
    const double square =
        plane.normal.dot(covariance * plane.normal) + distance * distance;
    return square <= limits_.distance * limits_.distance &&
           large.box.squaredExteriorDistance(small.box) <= limits_.gap * limits_.gap &&
           areNear(large, small);
  }

  Cube
  cubeOf(const Eigen::Vector3d& mean) const
  {
    return {std::floor(mean.x() / limits_.gap), std::floor(mean.y() / limits_.gap),
            std::floor(mean.z() / limits_.gap)};
  }

  // Whether two cells of the planes are within the gap. Only cells in neighbouring
  // cubes are compared.
  bool
  areNear(const Part& large, const Part& small) const
  {
    const double squared = limits_.gap * limits_.gap;
    const auto isNear = [&](const Cube& cube, const Eigen::Vector3d& mean) {
      auto found =
          std::lower_bound(large.cells.begin(), large.cells.end(), std::pair(cube, -1));
      for (; found != large.cells.end() && found->first == cube; ++found)
        if ((cells_[std::size_t(found->second)].mean - mean).squaredNorm() <= squared)
          return true;
      return false;
    };
    for (const auto& [cube, c] : small.cells) {
      const Eigen::Vector3d& mean = cells_[std::size_t(c)].mean;
      if (large.box.squaredExteriorDistance(mean) > squared)
        continue;
      for (double x = cube[0] - 1.0; x <= cube[0] + 1.0; ++x)
        for (double y = cube[1] - 1.0; y <= cube[1] + 1.0; ++y)
          for (double z = cube[2] - 1.0; z <= cube[2] + 1.0; ++z)
            if (isNear({x, y, z}, mean))
              return true;
    }
    return false;
  }

  const SurfaceCells& cells_;
  PlaneLimits limits_;
  double cosine_;
  std::vector<std::uint8_t> tries_;  // refused planes of each cell; most_tries = taken
  std::vector<std::uint32_t> visit_; // last visit of each cell
  std::uint32_t visits_ = 0;
};

} // namespace

std::vector<GrownPlane>
growPlanes(const SurfaceCells& cells, const PlaneLimits& limits)
{
  PlaneGrower grower(cells, limits);
  return grower.merged(grower.grow());
}

} // namespace pcl_semantic
