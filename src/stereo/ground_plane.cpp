// SPDX-License-Identifier: BSD-3-Clause
#include "ground_plane.h"

#include <pcl_semantic/core/exceptions.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

constexpr std::size_t min_points = 200;
constexpr std::size_t max_points = 20000; // more do not sharpen it
constexpr double scale = 0.05;            // of the Cauchy weights [m]
constexpr int rounds = 15;

std::vector<Eigen::Vector3d>
groundPoints(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
             const std::vector<std::uint8_t>& is_ground, double max_distance)
{
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (is_ground[i] && cloud[i].z < max_distance) // false for NaN
      points.push_back(cloud[i].getVector3fMap().cast<double>());
  if (points.size() <= max_points)
    return points;
  const std::size_t step = (points.size() + max_points - 1) / max_points;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); i += step)
    points[kept++] = points[i];
  points.resize(kept);
  return points;
}

// y = a x + b z + c, as (a, b, c).
Eigen::Vector3d
levelAtMedian(const std::vector<Eigen::Vector3d>& points)
{
  std::vector<double> heights;
  for (const Eigen::Vector3d& point : points)
    heights.push_back(point.y());
  const auto median = heights.begin() + std::ptrdiff_t(heights.size() / 2);
  std::nth_element(heights.begin(), median, heights.end());
  return {0.0, 0.0, *median};
}

// Residuals shrink from round to round, and the scale with them: far from the ground
// at first nothing would weigh.
Eigen::Vector3d
refit(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& plane,
      double width)
{
  Eigen::Matrix3d normal = Eigen::Matrix3d::Identity() * 1e-9;
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3d row(point.x(), point.z(), 1.0);
    const double residual = (point.y() - plane.dot(row)) / width;
    const double weight = 1.0 / (1.0 + residual * residual);
    normal += weight * row * row.transpose();
    right += weight * point.y() * row;
  }
  return normal.ldlt().solve(right);
}

} // namespace

std::optional<Eigen::Hyperplane<double, 3>>
fitGroundPlane(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
               const std::vector<std::uint8_t>& is_ground, double max_distance)
{
  if (is_ground.size() != cloud.size())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "ground plane: " << is_ground.size() << " flags for "
                                         << cloud.size() << " points");
  const std::vector<Eigen::Vector3d> points =
      groundPoints(cloud, is_ground, max_distance);
  if (points.size() < min_points)
    return std::nullopt;
  Eigen::Vector3d plane = levelAtMedian(points);
  for (int round = 0; round < rounds; ++round)
    plane = refit(points, plane, std::max(scale, std::ldexp(1.0, -round)));
  const Eigen::Vector3d normal(plane[0], -1.0, plane[1]); // y points down
  if (!(normal.norm() < 1.0 / std::cos(M_PI / 6.0)))
    return std::nullopt;
  return Eigen::Hyperplane<double, 3>(normal.normalized(), plane[2] / normal.norm());
}

Eigen::Vector3d
rightAlong(const Eigen::Hyperplane<double, 3>& ground)
{
  const Eigen::Vector3d right = Eigen::Vector3d::UnitX();
  return (right - right.dot(ground.normal()) * ground.normal()).normalized();
}

} // namespace pcl_semantic
