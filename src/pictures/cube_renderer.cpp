// SPDX-License-Identifier: BSD-3-Clause
#include "cube_renderer.h"

#include "core/fail.h"
#include "core/parallel_guard.h"

#include <pcl_semantic/map/voxel_set.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace pcl_semantic {

namespace {

constexpr double near_plane = 0.1; ///< [m]
constexpr int rows_of_band = 16;   ///< image rows per task of a thread

/** \brief The pixels that a cube may cover, borders included. */
struct Footprint {
  double min_z = 0.0; ///< camera z of the nearest corner [m]
  int first_row = 0, last_row = -1;
  int first_column = 0, last_column = -1;
};

/** \brief The scene relative to the camera's centre, in world axes. */
struct View {
  const std::vector<VoxelIndex>& voxels;
  double voxel_size;
  const StereoCamera& camera;
  Eigen::Isometry3d T_world_camera;
  double max_depth;

  /** \brief Lower corner of a voxel relative to the camera's centre [m]. Its upper
   * corner is bit-identical to the lower one of the next voxel, so there are no cracks.
   */
  Eigen::Vector3d
  lowerCorner(const VoxelIndex& index) const
  {
    return index.cast<double>() * voxel_size - T_world_camera.translation();
  }
};

/** \brief The footprint of a cube; empty if it is invisible. */
Footprint
footprintOf(const View& view, const VoxelIndex& voxel)
{
  const Eigen::Matrix3d rotation = view.T_world_camera.linear().transpose();
  const Eigen::Vector3d base = rotation * view.lowerCorner(voxel);
  const Eigen::Matrix3d edges = rotation * view.voxel_size;
  Eigen::Array2d lowest = Eigen::Array2d::Constant(1e9), highest = -lowest;
  Footprint result;
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
  // A little more than the exact rectangle, so that rounding loses no pixel. Clamped
  // first, because a pixel far outside may not fit an int.
  const Eigen::Array2d size(view.camera.width, view.camera.height);
  const Eigen::Array2d first = (lowest - 1e-6).max(0.0).min(size).ceil();
  const Eigen::Array2d last = (highest + 1e-6).max(-1.0).min(size - 1.0).floor();
  result.first_column = static_cast<int>(first.x());
  result.first_row = static_cast<int>(first.y());
  result.last_column = static_cast<int>(last.x());
  result.last_row = static_cast<int>(last.y());
  return result;
}

/** \brief Whether the neighbours towards the camera hide a cube for every ray: all
 * those at faces, edges and the corner. */
bool
isHidden(const View& view, const VoxelIndex& voxel, double min_z,
         VoxelSet::Reader& reader)
{
  // The neighbours must be drawn themselves.
  if (min_z < near_plane + 4.0 * view.voxel_size)
    return false;
  const Eigen::Vector3d lower = view.lowerCorner(voxel);
  VoxelIndex towards = VoxelIndex::Zero();
  for (int axis = 0; axis < 3; ++axis)
    if (lower[axis] > 0.0)
      towards[axis] = -1;
    else if (lower[axis] + view.voxel_size < 0.0)
      towards[axis] = 1;
  for (int mask = 1; mask < 8; ++mask) {
    VoxelIndex step = VoxelIndex::Zero();
    for (int axis = 0; axis < 3; ++axis)
      if (mask >> axis & 1)
        step[axis] = towards[axis];
    if (!step.isZero() && !reader.contains(voxel + step))
      return false;
  }
  return true;
}

/** \brief The footprint of every voxel, and the voxels that reach into each band of
 * rows. */
struct Plan {
  std::vector<Footprint> footprints;
  std::vector<std::vector<std::uint32_t>> bands;
};

Plan
planOf(const View& view)
{
  const auto count = static_cast<std::ptrdiff_t>(view.voxels.size());
  const VoxelSet set(view.voxels);
  Plan plan;
  plan.footprints.resize(view.voxels.size());
  plan.bands.resize((view.camera.height + rows_of_band - 1) / rows_of_band);
#pragma omp parallel
  {
    VoxelSet::Reader reader(set);
#pragma omp for schedule(static)
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      Footprint& footprint = plan.footprints[i];
      footprint = footprintOf(view, view.voxels[i]);
      if (footprint.first_row > footprint.last_row ||
          footprint.first_column > footprint.last_column)
        continue;
      if (isHidden(view, view.voxels[i], footprint.min_z, reader))
        footprint.last_row = -1;
    }
  }
  for (std::size_t i = 0; i < plan.footprints.size(); ++i) {
    const Footprint& footprint = plan.footprints[i];
    if (footprint.first_row > footprint.last_row ||
        footprint.first_column > footprint.last_column)
      continue;
    const int last = footprint.last_row / rows_of_band;
    for (int band = footprint.first_row / rows_of_band; band <= last; ++band)
      plan.bands[band].push_back(static_cast<std::uint32_t>(i));
  }
  return plan;
}

/** \brief The nearest cube of each pixel in some rows of the image. */
class Band {
public:
  Band(const View& view, int first_row, int end_row)
      : view_(view), first_row_(first_row), end_row_(end_row),
        width_(view.camera.width),
        depths_(pixelOf(end_row, 0), std::numeric_limits<double>::infinity()),
        nearest_(depths_.size()), inverse_directions_(depths_.size())
  {
    for (int row = first_row_; row < end_row_; ++row)
      for (int column = 0; column < width_; ++column) {
        // With z = 1 in the camera frame, the ray parameter is the depth.
        const Eigen::Vector3d direction =
            view_.T_world_camera.linear() * view_.camera.unproject(column, row, 1.0);
        for (int axis = 0; axis < 3; ++axis)
          inverse_directions_[pixelOf(row, column)][axis] =
              // Finite, so that 0 times it is 0: a ray along the border of two
              // half-open cubes belongs to the upper one.
              std::abs(direction[axis]) < 1e-200 ? 1e200 : 1.0 / direction[axis];
      }
  }

  void
  draw(const Footprint& footprint, std::uint32_t voxel)
  {
    const VoxelIndex& index = view_.voxels[voxel];
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
            (depth == depths_[pixel] && voxel < nearest_[pixel])) {
          depths_[pixel] = depth;
          nearest_[pixel] = voxel;
        }
      }
  }

  void
  copyTo(CubeImage& result) const
  {
    for (int row = first_row_; row < end_row_; ++row)
      for (int column = 0; column < width_; ++column) {
        const std::size_t pixel = pixelOf(row, column);
        if (!(depths_[pixel] <= view_.max_depth) || std::isinf(depths_[pixel]))
          continue;
        result.voxel.at<int>(row, column) = static_cast<int>(nearest_[pixel]);
        result.depth.at<double>(row, column) = depths_[pixel];
      }
  }

private:
  std::size_t
  pixelOf(int row, int column) const
  {
    return std::size_t(row - first_row_) * width_ + column;
  }

  /** \brief Depth at which a ray enters a box; infinite if it misses. */
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

/** \brief Renders the voxels of a band, the nearest first. */
void
renderBand(const View& view, Plan& plan, std::size_t number, CubeImage& result)
{
  const int first_row = static_cast<int>(number) * rows_of_band;
  Band band(view, first_row, std::min(first_row + rows_of_band, view.camera.height));
  std::vector<std::uint32_t>& voxels = plan.bands[number];
  std::sort(voxels.begin(), voxels.end(), [&](std::uint32_t a, std::uint32_t b) {
    const double z_a = plan.footprints[a].min_z, z_b = plan.footprints[b].min_z;
    return z_a != z_b ? z_a < z_b : a < b;
  });
  for (const std::uint32_t voxel : voxels)
    band.draw(plan.footprints[voxel], voxel);
  band.copyTo(result);
}

void
validate(const View& view)
{
  if (!(view.voxels.empty() || view.voxel_size > 0.0))
    badParameter("voxel size is ", view.voxel_size, " m, expected more than 0");
  if (view.voxels.size() > std::size_t(std::numeric_limits<int>::max()))
    badParameter(view.voxels.size(), " voxels, expected fewer than 2^31");
  view.camera.validate();
  if (view.camera.width <= 0 || view.camera.height <= 0)
    badParameter("the camera has no image size");
  if (!(view.max_depth > 0.0))
    badParameter("largest depth is ", view.max_depth, " m, expected more than 0");
}

} // namespace

CubeImage
renderCubes(const std::vector<VoxelIndex>& voxels, double voxel_size,
            const StereoCamera& camera, const Eigen::Isometry3d& T_world_camera,
            double max_depth)
{
  const View view{voxels, voxel_size, camera, T_world_camera, max_depth};
  validate(view);
  Plan plan = planOf(view);
  CubeImage result;
  result.voxel = cv::Mat(camera.height, camera.width, CV_32SC1, cv::Scalar(-1));
  result.depth = cv::Mat::zeros(camera.height, camera.width, CV_64FC1);
  const auto count = static_cast<std::ptrdiff_t>(plan.bands.size());
  ParallelGuard guard;
  // One thread per band, so the result does not depend on the number of threads.
#pragma omp parallel for schedule(dynamic)
  for (std::ptrdiff_t i = 0; i < count; ++i)
    guard.run([&] { renderBand(view, plan, std::size_t(i), result); });
  guard.rethrow();
  return result;
}

} // namespace pcl_semantic
