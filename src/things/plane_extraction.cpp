// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/things/plane_extraction.h>

#include "plane_growth.h"
#include "surface_cells.h"

#include "core/fail.h"
#include "core/point_spacing.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>
#include <utility>

namespace pcl_semantic {

namespace {

constexpr int kNoPlane = -1;

void
requireNotNegative(const char* name, double value)
{
  if (!(value >= 0.0 && std::isfinite(value)))
    badParameter(name, ": ", value, ", expected a number of 0 or more");
}

double
spacingOf(const std::vector<Eigen::Vector3d>& points)
{
  Eigen::MatrixXf positions(3, Eigen::Index(points.size()));
  // The median as origin keeps single precision, also beside a distant point.
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3 && !points.empty(); ++axis) {
    for (std::size_t i = 0; i < points.size(); ++i)
      values[i] = points[i][axis];
    const auto median = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), median, values.end());
    middle[axis] = *median;
  }
  for (std::size_t i = 0; i < points.size(); ++i)
    positions.col(Eigen::Index(i)) = (points[i] - middle).cast<float>();
  return double(pointSpacing(positions));
}

// Gives points to planes: the nearest plane of the cells around a point.
class PlaneAssignment {
public:
  PlaneAssignment(const SurfaceCells& cells, const std::vector<GrownPlane>& planes,
                  double distance)
      : cells_(cells), planes_(planes), distance_(distance),
        plane_of_cell_(cells.size(), kNoPlane)
  {
    for (std::size_t p = 0; p < planes.size(); ++p)
      for (const std::int32_t c : planes[p].cells)
        plane_of_cell_[std::size_t(c)] = int(p);
  }

  std::vector<int>
  assign(const std::vector<Eigen::Vector3d>& points) const
  {
    std::vector<int> plane_of_point(points.size(), kNoPlane);
    std::vector<int> near;
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      near.assign(1, plane_of_cell_[c]);
      cells_.forEachNeighbour(
          c, [&](std::size_t other) { near.push_back(plane_of_cell_[other]); });
      std::sort(near.begin(), near.end());
      near.erase(std::unique(near.begin(), near.end()), near.end());
      for (std::size_t i = cells_[c].first; i < cells_[c].last; ++i) {
        const std::size_t point = cells_.order()[i];
        plane_of_point[point] = nearest(points[point], near);
      }
    }
    return plane_of_point;
  }

private:
  // Of two planes at the same distance, the larger.
  int
  nearest(const Eigen::Vector3d& point, const std::vector<int>& near) const
  {
    int best = kNoPlane;
    double least = distance_;
    for (const int p : near) {
      if (p == kNoPlane)
        continue;
      const double distance = planes_[std::size_t(p)].plane.distance(point);
      if (distance < least || (best == kNoPlane && distance == least)) {
        best = p;
        least = distance;
      }
    }
    return best;
  }

  const SurfaceCells& cells_;
  const std::vector<GrownPlane>& planes_;
  double distance_;
  std::vector<int> plane_of_cell_;
};

// Fits each plane to the mean of its points in each cell.
std::vector<PlaneMoments>
momentsOf(const SurfaceCells& cells, const std::vector<Eigen::Vector3d>& points,
          const std::vector<int>& plane_of_point, const std::vector<GrownPlane>& planes)
{
  std::vector<PlaneMoments> moments;
  for (const GrownPlane& plane : planes)
    moments.emplace_back(plane.plane.centre);
  std::vector<std::pair<int, std::size_t>> members; // plane, place in the order
  for (std::size_t c = 0; c < cells.size(); ++c) {
    members.clear();
    for (std::size_t i = cells[c].first; i < cells[c].last; ++i)
      if (const int plane = plane_of_point[cells.order()[i]]; plane != kNoPlane)
        members.emplace_back(plane, i);
    std::sort(members.begin(), members.end());
    for (auto first = members.begin(); first != members.end();) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      auto last = first;
      for (; last != members.end() && last->first == first->first; ++last)
        sum += points[cells.order()[last->second]];
      moments[std::size_t(first->first)].add(sum / double(last - first));
      first = last;
    }
  }
  return moments;
}

/** \brief Planes of one search, and the points that it is done with. */
struct Search {
  std::vector<ExtractedPlane> planes; ///< their indices are places in `points`
  std::vector<bool> is_done;          ///< in a plane, or next to one
};

// Searches with resolved parameters.
Search
searchPlanes(const SurfaceCells& cells, const std::vector<Eigen::Vector3d>& points,
             const PlaneParameters& parameters)
{
  PlaneLimits limits;
  limits.angle = parameters.angle;
  limits.distance = parameters.distance;
  limits.gap = parameters.gap;
  limits.area = parameters.min_area;
  limits.square = 0.5 * parameters.radius;
  const std::vector<GrownPlane> grown = growPlanes(cells, limits);
  const std::vector<int> plane_of_point =
      PlaneAssignment(cells, grown, limits.distance).assign(points);
  const std::vector<PlaneMoments> moments =
      momentsOf(cells, points, plane_of_point, grown);
  Search search;
  search.planes.resize(grown.size());
  for (std::size_t p = 0; p < grown.size(); ++p) {
    const FittedPlane fitted = fitPlane(moments[p]);
    const FittedPlane& plane = fitted.normal.isZero() ? grown[p].plane : fitted;
    search.planes[p].normal = plane.normal;
    search.planes[p].radius = parameters.radius;
    search.planes[p].offset = -plane.normal.dot(plane.centre);
  }
  const std::vector<int> next_to =
      PlaneAssignment(cells, grown, 2.0 * limits.distance).assign(points);
  search.is_done.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    if (const int p = plane_of_point[i]; p != kNoPlane)
      search.planes[std::size_t(p)].indices.push_back(pcl::index_t(i));
  for (std::size_t i = 0; i < points.size(); ++i)
    search.is_done[i] = next_to[i] != kNoPlane &&
                        !search.planes[std::size_t(next_to[i])].indices.empty();
  return search;
}

// Points that noise spreads farther than the radius show no plane at this radius.
// Planes of twice the radius, in points that are not done.
std::vector<ExtractedPlane>
searchRest(const Search& search, const std::vector<Eigen::Vector3d>& points,
           PlaneParameters parameters)
{
  std::vector<Eigen::Vector3d> rest;
  pcl::Indices places;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!search.is_done[i]) {
      rest.push_back(points[i]);
      places.push_back(pcl::index_t(i));
    }
  parameters.radius *= 2.0;
  const SurfaceCells cells(rest, parameters.radius);
  std::vector<ExtractedPlane> planes =
      searchPlanes(cells, rest, parameters.resolved(cells.deviation())).planes;
  for (ExtractedPlane& plane : planes)
    for (pcl::index_t& i : plane.indices)
      i = places[std::size_t(i)];
  return planes;
}

constexpr double kCoplanar = 0.1; // largest angle between parts of one plane [rad]

using Box = Eigen::AlignedBox3d;

Box
boxOf(const ExtractedPlane& plane, const std::vector<Eigen::Vector3d>& points)
{
  Box box;
  for (const pcl::index_t i : plane.indices)
    box.extend(points[std::size_t(i)]);
  return box;
}

// Adds planes of the second search to those of the first one. A plane that continues
// one of these joins it, so that a wall stays one plane where its noise grows.
void
joinPlanes(std::vector<ExtractedPlane> rest, const std::vector<Eigen::Vector3d>& points,
           const PlaneParameters& first, std::vector<ExtractedPlane>& planes)
{
  std::vector<Box> boxes;
  for (const ExtractedPlane& plane : planes)
    boxes.push_back(boxOf(plane, points));
  for (ExtractedPlane& plane : rest) {
    const Box box = boxOf(plane, points);
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const pcl::index_t i : plane.indices)
      middle += points[std::size_t(i)] / double(plane.indices.size());
    ExtractedPlane* best = nullptr;
    double least = first.distance;
    for (std::size_t p = 0; p < boxes.size(); ++p) {
      const double distance = std::abs(planes[p].normal.dot(middle) + planes[p].offset);
      if (boxes[p].isEmpty() || distance > least ||
          std::abs(planes[p].normal.dot(plane.normal)) < std::cos(kCoplanar) ||
          boxes[p].exteriorDistance(box) > first.gap)
        continue;
      best = &planes[p];
      least = distance;
    }
    if (!best) {
      planes.push_back(std::move(plane));
      continue;
    }
    if (plane.indices.size() > best->indices.size()) {
      best->normal = plane.normal;
      best->offset = plane.offset;
    }
    pcl::Indices all;
    std::merge(best->indices.begin(), best->indices.end(), plane.indices.begin(),
               plane.indices.end(), std::back_inserter(all));
    best->indices = std::move(all);
    best->radius = plane.radius;
  }
}

} // namespace

void
PlaneParameters::validate() const
{
  requireNotNegative("radius of planes [m]", radius);
  requireNotNegative("distance of planes [m]", distance);
  requireNotNegative("gap of planes [m]", gap);
  requireNotNegative("minimum area of planes [m^2]", min_area);
  if (!(angle >= 0.0 && angle < M_PI_2))
    badParameter("angle of planes: ", angle, " rad, expected 0 to below pi/2");
}

double
PlaneParameters::automaticRadius(double spacing)
{
  return std::max(0.15, 3.0 * spacing);
}

PlaneParameters
PlaneParameters::resolved(double deviation) const
{
  const auto withDefault = [](double value, double automatic) {
    return value > 0.0 ? value : automatic;
  };
  PlaneParameters resolved = *this;
  const double noise = 3.0 * deviation / radius;
  resolved.angle = withDefault(angle, std::clamp(noise, 0.15, 0.5));
  resolved.distance = withDefault(distance, std::clamp(noise, 0.1, 0.4) * radius);
  resolved.gap = withDefault(gap, 5.0 * radius);
  resolved.min_area = withDefault(min_area, 5.0 * radius * radius);
  return resolved;
}

void
PlaneExtractionBase::setParameters(const PlaneParameters& parameters)
{
  parameters.validate();
  parameters_ = parameters;
}

std::vector<ExtractedPlane>
PlaneExtractionBase::extract(const std::vector<Eigen::Vector3d>& points,
                             const pcl::Indices& indices)
{
  PlaneParameters parameters = parameters_;
  if (parameters.radius == 0.0)
    parameters.radius = PlaneParameters::automaticRadius(spacingOf(points));
  const SurfaceCells cells(points, parameters.radius);
  resolved_ = parameters.resolved(cells.deviation());
  Search search = searchPlanes(cells, points, resolved_);
  std::vector<ExtractedPlane>& planes = search.planes;
  joinPlanes(searchRest(search, points, parameters), points, resolved_, planes);
  using Lowest = std::tuple<double, double, double>;
  std::vector<std::pair<Lowest, std::size_t>> order;
  for (std::size_t p = 0; p < planes.size(); ++p) {
    if (planes[p].indices.empty())
      continue;
    Lowest lowest(HUGE_VAL, 0.0, 0.0);
    for (pcl::index_t& i : planes[p].indices) {
      const Eigen::Vector3d& point = points[std::size_t(i)];
      lowest = std::min(lowest, {point.z(), point.y(), point.x()});
      i = indices[std::size_t(i)];
    }
    order.emplace_back(lowest, p);
  }
  std::sort(order.begin(), order.end());
  std::vector<ExtractedPlane> sorted;
  for (const auto& [lowest, p] : order)
    sorted.push_back(std::move(planes[p]));
  return sorted;
}

} // namespace pcl_semantic
