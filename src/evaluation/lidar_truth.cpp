/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/lidar_truth.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

/** \brief Nearer returns mean nothing this close to the camera [m]. */
constexpr double near_plane = 0.1;

constexpr float no_return = std::numeric_limits<float>::infinity();

bool
isOccluded(const cv::Mat1f& depths, int row, int column,
           const LidarTruthParameters& parameters)
{
  const double depth = depths(row, column);
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

cv::Mat
projectLidarTruth(const pcl::PointCloud<pcl::PointXYZI>& scan,
                  const std::vector<Label>& labels, const StereoCamera& camera,
                  const Eigen::Isometry3d& T_camera_scanner,
                  const LidarTruthParameters& parameters)
{
  if (labels.size() != scan.size())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "there are " << labels.size() << " labels for " << scan.size()
                                     << " points");
  if (camera.width <= 0 || camera.height <= 0)
    PCL_THROW_EXCEPTION(InvalidParameterException, "the camera has no image size");

  cv::Mat1f depths(camera.height, camera.width, no_return);
  cv::Mat1b nearest(camera.height, camera.width, kUnlabelled);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Eigen::Vector3d point =
        T_camera_scanner * scan[i].getVector3fMap().cast<double>();
    if (!(point.z() > near_plane))
      continue;
    const Eigen::Vector2d pixel =
        (camera.project(point) + Eigen::Vector2d(0.5, 0.5)).array().floor();
    if (!(pixel.x() >= 0 && pixel.x() < camera.width && pixel.y() >= 0 &&
          pixel.y() < camera.height))
      continue;
    const int row = static_cast<int>(pixel.y()), column = static_cast<int>(pixel.x());
    const float depth = static_cast<float>(point.z());
    if (depth < depths(row, column)) {
      depths(row, column) = depth;
      nearest(row, column) = labels[i];
    }
  }

  cv::Mat1b truth(camera.height, camera.width, kUnlabelled);
  for (int row = 0; row < truth.rows; ++row)
    for (int column = 0; column < truth.cols; ++column)
      if (nearest(row, column) != kUnlabelled &&
          depths(row, column) <= parameters.max_depth &&
          !isOccluded(depths, row, column, parameters))
        truth(row, column) = nearest(row, column);
  return truth;
}

} // namespace pcl_semantic
