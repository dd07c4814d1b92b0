// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_features.h"
#include "ground_plane.h"

#include <pcl_semantic/core/exceptions.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

constexpr int window = 7; // of the smoothing [px]
constexpr int reach = 5;  // of the differences, to each side [px]

using Cloud = pcl::PointCloud<pcl::PointXYZRGB>;

// Sums of xyz and of the points there are, over the window: their quotient is the mean.
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
  return Eigen::Vector3f(sum[0], sum[1], sum[2]) / sum[3]; // NaN if nothing is there
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
  return std::abs(normal.dot(up)) / normal.norm(); // NaN if there is none
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

std::vector<PointFeatures>
cloudFeatures(const Cloud& cloud,
              const std::optional<Eigen::Hyperplane<double, 3>>& ground)
{
  if (!cloud.isOrganized() && !cloud.empty())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "normals from neighbours need an organized cloud");
  std::vector<PointFeatures> features(cloud.size());
#pragma omp parallel for
  for (std::size_t i = 0; i < cloud.size(); ++i)
    features[i].setColour(cloud[i].r, cloud[i].g, cloud[i].b);
  if (ground && !cloud.empty())
    addGeometry(cloud, *ground, features);
  return features;
}

} // namespace pcl_semantic
