// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/labelling/visible_points.h>

#include "core/fail.h"

#include <opencv2/core/mat.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

// Nearer returns are unusable [m].
constexpr double near_plane = 0.1;

constexpr float no_return = std::numeric_limits<float>::infinity();

// Camera z of the nearest return per pixel.
cv::Mat1f
nearestDepths(const std::vector<SeenPoint>& projected, const StereoCamera& camera)
{
  cv::Mat1f depths(camera.height, camera.width, no_return);
  for (const SeenPoint& p : projected)
    if (p.row >= 0)
      depths(p.row, p.column) = std::min(depths(p.row, p.column), p.depth);
  return depths;
}

bool
isHidden(const cv::Mat1f& depths, const SeenPoint& point,
         const VisibilityParameters& parameters)
{
  const int row = point.row, column = point.column;
  const double depth = point.depth;
  const double limit =
      depth - std::max(parameters.absolute_margin, parameters.relative_margin * depth);
  bool above = false, below = false;
  const int first_row = std::max(row - parameters.window_rows, 0);
  const int last_row = std::min(row + parameters.window_rows, depths.rows - 1);
  const int first_column = std::max(column - parameters.window_columns, 0);
  const int last_column = std::min(column + parameters.window_columns, depths.cols - 1);
  for (int v = first_row; v <= last_row; ++v)
    for (int u = first_column; u <= last_column; ++u)
      if (depths(v, u) < limit) {
        above = above || v <= row;
        below = below || v >= row;
      }
  return above && below;
}

} // namespace

void
VisibilityParameters::validate() const
{
  if (!(max_depth > 0.0))
    badParameter("max_depth is ", max_depth, ", expected more than 0");
  if (window_columns < 0 || window_rows < 0)
    badParameter("the window for occlusion is ", window_columns, " x ", window_rows,
                 " px, expected 0 or more");
}

std::optional<Eigen::Vector2i>
pixelOf(const Eigen::Vector3d& point, const StereoCamera& camera)
{
  if (!(point.z() > near_plane))
    return std::nullopt;
  const Eigen::Vector2d pixel =
      (camera.project(point) + Eigen::Vector2d(0.5, 0.5)).array().floor();
  if (!(pixel.x() >= 0 && pixel.x() < camera.width && pixel.y() >= 0 &&
        pixel.y() < camera.height))
    return std::nullopt;
  return pixel.cast<int>();
}

std::vector<SeenPoint>
seenPoints(const std::vector<Eigen::Vector3d>& points, const StereoCamera& camera,
           const VisibilityParameters& parameters)
{
  if (camera.width <= 0 || camera.height <= 0)
    badParameter("the camera has no image size");
  std::vector<SeenPoint> seen(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    if (const auto pixel = pixelOf(points[i], camera))
      seen[i] = {pixel->y(), pixel->x(), float(points[i].z())};
  const cv::Mat1f depths = nearestDepths(seen, camera);
  for (SeenPoint& point : seen)
    if (point.row >= 0 &&
        (point.depth > parameters.max_depth || isHidden(depths, point, parameters)))
      point = SeenPoint();
  return seen;
}

} // namespace pcl_semantic
