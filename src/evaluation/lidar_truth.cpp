// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/lidar_truth.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

// Nearer returns mean nothing this close to the camera [m].
constexpr double near_plane = 0.1;

constexpr float no_return = std::numeric_limits<float>::infinity();

// A point in the image; those behind the camera or beside it are outside.
struct Projection {
  int row = -1, column = -1;
  float depth = 0.0f; // camera z [m]

  bool
  isInside() const
  {
    return row >= 0;
  }
};

Projection
project(const Eigen::Vector3d& point, const StereoCamera& camera)
{
  const auto pixel = pixelOf(point, camera);
  return pixel ? Projection{pixel->y(), pixel->x(), static_cast<float>(point.z())}
               : Projection();
}

std::vector<Projection>
projectScan(const pcl::PointCloud<pcl::PointXYZI>& scan, const StereoCamera& camera,
            const Eigen::Isometry3d& T_camera_scanner)
{
  if (camera.width <= 0 || camera.height <= 0)
    PCL_THROW_EXCEPTION(InvalidParameterException, "the camera has no image size");
  std::vector<Projection> projections;
  projections.reserve(scan.size());
  for (const pcl::PointXYZI& point : scan)
    projections.push_back(
        project(T_camera_scanner * point.getVector3fMap().cast<double>(), camera));
  return projections;
}

// Camera z of the nearest return of each pixel.
cv::Mat1f
nearestDepths(const std::vector<Projection>& projections, const StereoCamera& camera)
{
  cv::Mat1f depths(camera.height, camera.width, no_return);
  for (const Projection& p : projections)
    if (p.isInside())
      depths(p.row, p.column) = std::min(depths(p.row, p.column), p.depth);
  return depths;
}

bool
isOccluded(const cv::Mat1f& depths, const Projection& point,
           const LidarTruthParameters& parameters)
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

std::vector<float>
seenDepths(const std::vector<Projection>& projections, const cv::Mat1f& depths,
           const LidarTruthParameters& parameters)
{
  std::vector<float> seen(projections.size(), 0.0f);
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (projections[i].isInside() && projections[i].depth <= parameters.max_depth &&
        !isOccluded(depths, projections[i], parameters))
      seen[i] = projections[i].depth;
  return seen;
}

} // namespace

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

std::vector<float>
seenDepths(const pcl::PointCloud<pcl::PointXYZI>& scan, const StereoCamera& camera,
           const Eigen::Isometry3d& T_camera_scanner,
           const LidarTruthParameters& parameters)
{
  const auto projections = projectScan(scan, camera, T_camera_scanner);
  return seenDepths(projections, nearestDepths(projections, camera), parameters);
}

LidarTruth
projectLidarTruth(const pcl::PointCloud<pcl::PointXYZI>& scan,
                  const std::vector<Label>& labels, const StereoCamera& camera,
                  const Eigen::Isometry3d& T_camera_scanner,
                  const LidarTruthParameters& parameters)
{
  if (labels.size() != scan.size())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "there are " << labels.size() << " labels for " << scan.size()
                                     << " points");
  const auto projections = projectScan(scan, camera, T_camera_scanner);
  const cv::Mat1f depths = nearestDepths(projections, camera);
  const std::vector<float> seen = seenDepths(projections, depths, parameters);
  cv::Mat1b truth(camera.height, camera.width, kUnlabelled);
  cv::Mat1f depth(camera.height, camera.width, 0.0f);
  cv::Mat1b taken(camera.height, camera.width, std::uint8_t(0));
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Projection& p = projections[i];
    if (!p.isInside() || p.depth != depths(p.row, p.column) || taken(p.row, p.column))
      continue;
    taken(p.row, p.column) = 1; // the first of equally near returns
    if (labels[i] == kUnlabelled || seen[i] == 0.0f)
      continue;
    truth(p.row, p.column) = labels[i];
    depth(p.row, p.column) = p.depth;
  }
  return {truth, depth};
}

} // namespace pcl_semantic
