// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/things/plane_summary.h>

#include "core/fail.h"
#include "plane_raster.h"

#include <boost/geometry.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/ring.hpp>
#include <boost/polygon/polygon.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace pcl_semantic {

namespace {

constexpr double kMostSquares = 1 << 28; // from the origin

using Corner = boost::geometry::model::d2::point_xy<double>; // column, row
using Ring = boost::geometry::model::ring<Corner>;
using Squares = boost::polygon::polygon_90_set_data<int>;
using Outline = boost::polygon::polygon_90_with_holes_data<int>;

// The squares, with gaps of up to two squares closed.
std::vector<Outline>
outlinesOf(const std::vector<PlaneRaster::Square>& squares)
{
  Squares set;
  for (std::size_t first = 0; first < squares.size();) {
    std::size_t last = first + 1; // of a run in one row
    while (last < squares.size() && squares[last].first == squares[first].first &&
           squares[last].second == squares[last - 1].second + 1)
      ++last;
    set.insert(boost::polygon::rectangle_data<int>(
        squares[first].second, squares[first].first, squares[last - 1].second + 1,
        squares[first].first + 1));
    first = last;
  }
  boost::polygon::bloat(set, 1);
  boost::polygon::shrink(set, 1);
  std::vector<Outline> outlines;
  set.get(outlines);
  return outlines;
}

// \param[in] clockwise seen against the normal
template <typename Corners>
PlaneRing
ringOf(const Corners& corners, const PlaneRaster& raster, bool clockwise)
{
  Ring ring, simple;
  for (const auto& corner : corners)
    ring.emplace_back(double(boost::polygon::x(corner)),
                      double(boost::polygon::y(corner)));
  boost::geometry::correct(ring); // closed, clockwise
  boost::geometry::simplify(ring, simple, 1.0);
  if (simple.size() < 4) // would have no area
    simple = ring;
  if (!clockwise)
    std::reverse(simple.begin(), simple.end());
  simple.pop_back(); // the first corner again
  PlaneRing result;
  for (const Corner& corner : simple)
    result.push_back(raster.position(corner.y(), corner.x()));
  return result;
}

PlanePolygon
polygonOf(const Outline& outline, const PlaneRaster& raster)
{
  PlanePolygon polygon;
  polygon.outer = ringOf(
      std::vector<boost::polygon::point_data<int>>(outline.begin(), outline.end()),
      raster, false);
  for (auto hole = outline.begin_holes(); hole != outline.end_holes(); ++hole)
    polygon.holes.push_back(
        ringOf(std::vector<boost::polygon::point_data<int>>(hole->begin(), hole->end()),
               raster, true));
  return polygon;
}

} // namespace

PlaneSummary
summarizePlane(const ExtractedPlane& plane,
               const std::function<Eigen::Vector3d(std::size_t)>& position,
               const std::function<Label(std::size_t)>& label, double square)
{
  if (!(square > 0.0 && std::isfinite(square)))
    badParameter("squares of planes: ", square, " m, expected a positive number");
  PlaneSummary summary;
  summary.points = plane.indices.size();
  summary.normal = plane.normal;
  summary.offset = plane.offset;
  std::array<std::size_t, 256> votes{};
  PlaneRaster raster(plane.normal, -plane.offset * plane.normal, square);
  for (const pcl::index_t i : plane.indices) {
    ++votes[label(std::size_t(i))];
    const Eigen::Vector3d point = position(std::size_t(i));
    if (!(point.cwiseAbs().maxCoeff() < kMostSquares * square))
      badInput("a plane lies at ", point.transpose(), " m, expected at most ",
               kMostSquares * square, " m for squares of ", square, " m");
    raster.add(point);
  }
  const auto most = std::max_element(votes.begin() + 1, votes.end());
  if (*most > 0)
    summary.label = Label(most - votes.begin());
  for (const Outline& outline : outlinesOf(raster.squares())) {
    summary.area += double(boost::polygon::area(outline)) * square * square;
    summary.polygons.push_back(polygonOf(outline, raster));
  }
  return summary;
}

CloudPlanes
findPlanes(const pcl::PointCloud<pcl::PointXYZRGBL>::ConstPtr& cloud, double voxel_size,
           const Eigen::Vector3d& origin, PlaneParameters parameters)
{
  if (parameters.radius == 0.0 && voxel_size > 0.0)
    parameters.radius = PlaneParameters::automaticRadius(voxel_size);
  CloudPlanes found;
  found.numbers.assign(cloud->size(), 0);
  PlaneExtraction<pcl::PointXYZRGBL> extraction;
  extraction.setParameters(parameters);
  extraction.setInputCloud(cloud);
  const auto position = [&](std::size_t i) -> Eigen::Vector3d {
    return (*cloud)[i].getVector3fMap().cast<double>() + origin;
  };
  const auto label = [&](std::size_t i) { return Label((*cloud)[i].label); };
  for (ExtractedPlane& plane : extraction.extract()) {
    plane.offset -= plane.normal.dot(origin);
    found.planes.push_back(summarizePlane(plane, position, label, 0.5 * plane.radius));
    found.planes.back().id = std::uint32_t(found.planes.size());
    for (const pcl::index_t i : plane.indices)
      found.numbers[std::size_t(i)] = found.planes.back().id;
  }
  return found;
}

} // namespace pcl_semantic
