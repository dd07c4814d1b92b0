/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/label_reprojection.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcl_semantic {

namespace {

constexpr double near_plane = 0.1; ///< [m]
constexpr int rows_of_band = 16; ///< rows of the image that one thread fills at a time

/** \brief The pixels a cube may cover, borders included. */
struct Footprint {
  double min_z = 0.0; ///< camera z of the nearest corner [m]
  std::uint32_t voxel = 0;
  int first_row = 0, last_row = -1;
  int first_column = 0, last_column = -1;
};

/** \brief The world seen from the camera's centre, axes of the world. */
struct View {
  const VoxelCloud& voxels;
  const StereoCamera& camera;
  Eigen::Isometry3d T_world_camera;
  double max_depth;

  /** \brief Lower corner of a voxel relative to the camera's centre [m]. Its upper one
   * is the lower one of the next, to the bit: no crack between neighbours. */
  Eigen::Vector3d
  lowerCorner(const VoxelIndex& index) const
  {
    return index.cast<double>() * voxels.voxel_size - T_world_camera.translation();
  }
};

/** \brief The footprint of a cube; one without pixels if it cannot be seen. */
Footprint
footprintOf(const View& view, std::size_t voxel)
{
  const Eigen::Matrix3d rotation = view.T_world_camera.linear().transpose();
  const Eigen::Vector3d base = rotation * view.lowerCorner(view.voxels.indices[voxel]);
  const Eigen::Matrix3d edges = rotation * view.voxels.voxel_size;
  Eigen::Array2d lowest = Eigen::Array2d::Constant(1e9), highest = -lowest;
  Footprint result;
  result.voxel = static_cast<std::uint32_t>(voxel);
  result.min_z = base.z() + edges.row(2).cwiseMin(0.0).sum();
  if (!(result.min_z >= near_plane && result.min_z <= view.max_depth))
    return result;
  for (int corner = 0; corner < 8; ++corner) {
    Eigen::Vector3d point = base;
    for (int axis = 0; axis < 3; ++axis)
      if (corner >> axis & 1)
        point += edges.col(axis);
    const Eigen::Array2d pixel = view.camera.project(point).array();
    lowest = lowest.min(pixel);
    highest = highest.max(pixel);
  }
  // A little more than the exact rectangle: rounding must not cost a pixel. The clamps
  // come first, for a pixel far outside may not fit an int.
  const Eigen::Array2d size(view.camera.width, view.camera.height);
  const Eigen::Array2d first = (lowest - 1e-6).max(0.0).min(size).ceil();
  const Eigen::Array2d last = (highest + 1e-6).max(-1.0).min(size - 1.0).floor();
  result.first_column = static_cast<int>(first.x());
  result.first_row = static_cast<int>(first.y());
  result.last_column = static_cast<int>(last.x());
  result.last_row = static_cast<int>(last.y());
  return result;
}

/** \brief Footprints of the cubes in view, the nearest first. */
std::vector<Footprint>
sortedFootprints(const View& view)
{
  const auto count = static_cast<std::ptrdiff_t>(view.voxels.size());
  std::vector<Footprint> footprints(view.voxels.size());
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t i = 0; i < count; ++i)
    footprints[i] = footprintOf(view, static_cast<std::size_t>(i));
  const auto end = std::remove_if(
      footprints.begin(), footprints.end(), [](const Footprint& footprint) {
        return footprint.first_row > footprint.last_row ||
               footprint.first_column > footprint.last_column;
      });
  footprints.erase(end, footprints.end());
  std::sort(footprints.begin(), footprints.end(), [](const auto& a, const auto& b) {
    return a.min_z != b.min_z ? a.min_z < b.min_z : a.voxel < b.voxel;
  });
  return footprints;
}

/** \brief Some rows of the image: the nearest cube of each pixel. The constructor takes
 * all memory that is needed, so that nothing throws once the threads work. */
class Band {
public:
  Band(const View& view, int first_row, int end_row)
      : view_(view), first_row_(first_row), end_row_(end_row),
        width_(view.camera.width),
        depths_(pixelOf(end_row, 0), std::numeric_limits<double>::infinity()),
        nearest_(depths_.size()), inverse_directions_(depths_.size())
  {}

  void
  castRays()
  {
    for (int row = first_row_; row < end_row_; ++row)
      for (int column = 0; column < width_; ++column) {
        // With a direction of camera z = 1 the ray parameter is the depth.
        const Eigen::Vector3d direction =
            view_.T_world_camera.linear() * view_.camera.unproject(column, row, 1.0);
        for (int axis = 0; axis < 3; ++axis)
          inverse_directions_[pixelOf(row, column)][axis] =
              // Finite, so that 0 times it is 0: a ray along the border of two cubes
              // belongs to the upper one, as the half-open cubes say.
              std::abs(direction[axis]) < 1e-200 ? 1e200 : 1.0 / direction[axis];
      }
  }

  void
  draw(const Footprint& footprint)
  {
    if (footprint.last_row < first_row_ || footprint.first_row >= end_row_)
      return;
    const VoxelIndex& index = view_.voxels.indices[footprint.voxel];
    const Eigen::Vector3d lower = view_.lowerCorner(index);
    const Eigen::Vector3d upper = view_.lowerCorner(index + VoxelIndex::Ones());
    const int last_row = std::min(footprint.last_row, end_row_ - 1);
    for (int row = std::max(footprint.first_row, first_row_); row <= last_row; ++row)
      for (int column = footprint.first_column; column <= footprint.last_column;
           ++column) {
        const std::size_t pixel = pixelOf(row, column);
        if (depths_[pixel] < footprint.min_z)
          continue;
        const double depth = hit(lower, upper, inverse_directions_[pixel]);
        if (depth < depths_[pixel] ||
            (depth == depths_[pixel] && footprint.voxel < nearest_[pixel])) {
          depths_[pixel] = depth;
          nearest_[pixel] = footprint.voxel;
        }
      }
  }

  void
  copyTo(RenderedLabels& result) const
  {
    for (int row = first_row_; row < end_row_; ++row)
      for (int column = 0; column < width_; ++column) {
        const std::size_t pixel = pixelOf(row, column);
        if (!(depths_[pixel] <= view_.max_depth) || std::isinf(depths_[pixel]))
          continue;
        const auto& point = view_.voxels.cloud->points[nearest_[pixel]];
        result.labels.at<std::uint8_t>(row, column) =
            static_cast<std::uint8_t>(point.label);
        result.depth.at<float>(row, column) = static_cast<float>(depths_[pixel]);
        result.voxels.at<std::int32_t>(row, column) =
            static_cast<std::int32_t>(nearest_[pixel]);
      }
  }

private:
  std::size_t
  pixelOf(int row, int column) const
  {
    return std::size_t(row - first_row_) * width_ + column;
  }

  /** \brief Depth at which a ray enters a box; infinite if it passes by. */
  static double
  hit(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper,
      const std::array<double, 3>& inverse_direction)
  {
    double enter = 0.0, leave = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      const double a = lower[axis] * inverse_direction[axis];
      const double b = upper[axis] * inverse_direction[axis];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return enter < leave ? enter : std::numeric_limits<double>::infinity();
  }

  const View& view_;
  int first_row_, end_row_, width_;
  std::vector<double> depths_;         ///< [m]
  std::vector<std::uint32_t> nearest_; ///< voxels
  std::vector<std::array<double, 3>> inverse_directions_;
};

void
validate(const VoxelCloud& voxels, const StereoCamera& camera, double max_depth)
{
  if (!voxels.cloud || voxels.cloud->size() != voxels.size())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "the voxels have " << voxels.size() << " indices, their cloud "
                                           << (voxels.cloud ? voxels.cloud->size() : 0)
                                           << " points");
  if (!(voxels.size() == 0 || voxels.voxel_size > 0.0))
    PCL_THROW_EXCEPTION(InvalidParameterException, "voxel size is "
                                                       << voxels.voxel_size
                                                       << " m, expected more than 0");
  camera.validate();
  if (camera.width <= 0 || camera.height <= 0)
    PCL_THROW_EXCEPTION(InvalidParameterException, "the camera has no image size");
  if (!(max_depth > 0.0))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "largest depth is " << max_depth << " m, expected more than 0");
}

} // namespace

RenderedLabels
renderLabels(const VoxelCloud& voxels, const StereoCamera& camera,
             const Eigen::Isometry3d& T_world_camera, double max_depth)
{
  validate(voxels, camera, max_depth);
  const View view{voxels, camera, T_world_camera, max_depth};
  const std::vector<Footprint> footprints = sortedFootprints(view);
  RenderedLabels result;
  result.labels = cv::Mat::zeros(camera.height, camera.width, CV_8UC1);
  result.depth = cv::Mat::zeros(camera.height, camera.width, CV_32FC1);
  result.voxels = cv::Mat(camera.height, camera.width, CV_32SC1, cv::Scalar(-1));
  std::vector<Band> bands;
  for (int row = 0; row < camera.height; row += rows_of_band)
    bands.emplace_back(view, row, std::min(row + rows_of_band, camera.height));
  const auto count = static_cast<std::ptrdiff_t>(bands.size());
  // Each band is one thread's alone: nothing depends on their number.
#pragma omp parallel for schedule(dynamic)
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    bands[i].castRays();
    for (const Footprint& footprint : footprints)
      bands[i].draw(footprint);
    bands[i].copyTo(result);
  }
  return result;
}

} // namespace pcl_semantic
