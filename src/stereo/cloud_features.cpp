// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_features.h"
#include "core/cloud_size.h"
#include "core/fail.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZRGB>;

constexpr std::size_t min_points = 200;
constexpr std::size_t max_points = 20000; // more points do not improve the result
constexpr double scale = 0.05;            // of the Cauchy weights [m]
constexpr int rounds = 15;

std::vector<Eigen::Vector3d>
groundPoints(const Cloud& cloud, const std::vector<std::uint8_t>& is_ground,
             double max_distance)
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

// The scale shrinks with the residuals from round to round. With the final scale,
// points far from the initial plane would have no weight.
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

constexpr int window = 7; // of the smoothing [px]
constexpr int reach = 5;  // half width of the differences [px]

// Sums of xyz and the number of points in the window; their quotient is the mean.
cv::Mat
windowSums(const Cloud& cloud)
{
  cv::Mat points(int(cloud.height), int(cloud.width), CV_32FC4);
#pragma omp parallel for
  for (int v = 0; v < points.rows; ++v) {
    auto* const row = points.ptr<cv::Vec4f>(v);
    for (int u = 0; u < points.cols; ++u) {
      const pcl::PointXYZRGB& point = cloud(std::size_t(u), std::size_t(v));
      const bool is_there = std::isfinite(point.z);
      row[u] = is_there ? cv::Vec4f(point.x, point.y, point.z, 1.0f) : cv::Vec4f();
    }
  }
  cv::Mat sums;
  cv::boxFilter(points, sums, CV_32F, {window, window}, {-1, -1}, false,
                cv::BORDER_CONSTANT);
  return sums;
}

Eigen::Vector3f
meanOf(const cv::Vec4f& sum)
{
  return Eigen::Vector3f(sum[0], sum[1], sum[2]) / sum[3]; // NaN without points
}

float
levelOf(const cv::Mat& sums, int u, int v, const Eigen::Vector3f& up)
{
  const int left = std::max(u - reach, 0);
  const int right = std::min(u + reach, sums.cols - 1);
  const int above = std::max(v - reach, 0);
  const int below = std::min(v + reach, sums.rows - 1);
  const Eigen::Vector3f along =
      meanOf(sums.at<cv::Vec4f>(v, right)) - meanOf(sums.at<cv::Vec4f>(v, left));
  const Eigen::Vector3f down =
      meanOf(sums.at<cv::Vec4f>(below, u)) - meanOf(sums.at<cv::Vec4f>(above, u));
  const Eigen::Vector3f normal = along.cross(down);
  return std::abs(normal.dot(up)) / normal.norm(); // NaN without a normal
}

// To the right of the camera along the ground, unit length.
Eigen::Vector3d
rightAlong(const Eigen::Hyperplane<double, 3>& ground)
{
  const Eigen::Vector3d right = Eigen::Vector3d::UnitX();
  return (right - right.dot(ground.normal()) * ground.normal()).normalized();
}

void
addGeometry(const Cloud& cloud, const Eigen::Hyperplane<double, 3>& ground,
            std::vector<PointFeatures>& features)
{
  const cv::Mat sums = windowSums(cloud);
  const Eigen::Vector3f up = ground.normal().cast<float>();
  const Eigen::Vector3f right = rightAlong(ground).cast<float>();
  const auto offset = static_cast<float>(ground.offset());
#pragma omp parallel for
  for (int v = 0; v < sums.rows; ++v)
    for (int u = 0; u < sums.cols; ++u) {
      const std::size_t i = std::size_t(v) * cloud.width + std::size_t(u);
      if (!std::isfinite(cloud[i].z))
        continue;
      const Eigen::Vector3f position = cloud[i].getVector3fMap();
      features[i][Feature::height] = up.dot(position) + offset;
      features[i][Feature::distance] = position.z();
      features[i][Feature::level] = levelOf(sums, u, v, up);
      features[i][Feature::side] = std::abs(right.dot(position));
    }
}

} // namespace

std::optional<Eigen::Hyperplane<double, 3>>
fitGroundPlane(const Cloud& cloud, const std::vector<std::uint8_t>& is_ground,
               double max_distance)
{
  if (is_ground.size() != cloud.size())
    badParameter("ground plane: ", is_ground.size(), " flags for ", cloud.size(),
                 " points");
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

std::vector<PointFeatures>
cloudFeatures(const Cloud& cloud,
              const std::optional<Eigen::Hyperplane<double, 3>>& ground)
{
  requireCloudSize(cloud);
  if (!cloud.isOrganized() && !cloud.empty())
    badParameter("normals from neighbours need an organized cloud");
  std::vector<PointFeatures> features(cloud.size());
#pragma omp parallel for
  for (std::size_t i = 0; i < cloud.size(); ++i)
    features[i].setColour(cloud[i].r, cloud[i].g, cloud[i].b);
  if (ground && !cloud.empty())
    addGeometry(cloud, *ground, features);
  return features;
}

} // namespace pcl_semantic
