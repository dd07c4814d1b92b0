// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pictures/scene_view.h>

#include "core/fail.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

constexpr double kPi = 3.14159265358979323846;

// A sample of the voxels, evenly spaced in the list, that represents the map's extent.
std::vector<Eigen::Vector3d>
sampleOf(const VoxelScene& scene)
{
  constexpr std::size_t enough = 20000;
  const std::vector<VoxelIndex>& indices = scene.voxels.indices;
  const std::size_t step = std::max<std::size_t>(1, indices.size() / enough);
  std::vector<Eigen::Vector3d> sample;
  for (std::size_t i = 0; i < indices.size(); i += step)
    sample.emplace_back(centreOf(indices[i], scene.grid.size));
  return sample;
}

// Horizontal direction of the largest variance.
Eigen::Vector3d
mainDirection(const std::vector<Eigen::Vector3d>& points)
{
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector3d& point : points)
    mean += (point - points.front()).head<2>() / double(points.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector2d each = (point - points.front()).head<2>() - mean;
    spread += each * each.transpose();
  }
  if (!(spread.trace() > 0.0))
    return Eigen::Vector3d::UnitX();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(spread);
  const Eigen::Vector2d direction = solver.eigenvectors().col(1);
  // The sign is arbitrary: forward along the world's axes.
  const double sign = direction.x() + 1e-3 * direction.y() < 0.0 ? -1.0 : 1.0;
  return {sign * direction.x(), sign * direction.y(), 0.0};
}

Eigen::Vector3d
freeDirectionOf(const std::vector<Eigen::Vector3d>& sample, const SensorPath& path)
{
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i)
    length += (path[i] - path[i - 1]).head<2>().norm();
  if (length < 1.0)
    return mainDirection(sample);
  Eigen::Vector3d way = path.back() - path.front();
  way.z() = 0.0;
  // A closed path has no direction from first to last position.
  return way.norm() > 0.4 * length ? way.normalized() : mainDirection(path);
}

// The viewing direction of a render: a world axis if one is close, so that cubes and
// grid are axis-aligned.
Eigen::Vector3d
directionOf(const std::vector<Eigen::Vector3d>& sample, const SensorPath& path)
{
  const Eigen::Vector3d direction = freeDirectionOf(sample, path);
  for (int axis = 0; axis < 2; ++axis)
    if (std::abs(direction[axis]) > std::cos(15.0 * kPi / 180.0))
      return std::copysign(1.0, direction[axis]) * Eigen::Vector3d::Unit(axis);
  return direction;
}

// Whether a path, seen from above, bends to the right.
bool
bendsToTheRight(const SensorPath& path)
{
  if (path.size() < 4)
    return false;
  const std::size_t quarter = path.size() / 4;
  const Eigen::Vector3d first = path[quarter] - path.front(),
                        last = path.back() - path[path.size() - 1 - quarter];
  return first.cross(last).z() < -0.05 * first.norm() * last.norm();
}

// The range of values without outliers.
struct Range {
  double low = 0.0, high = 0.0;

  Range(std::vector<double> values, double left_out)
  {
    std::sort(values.begin(), values.end());
    const double last = double(values.size() - 1);
    low = values[std::size_t(std::floor(left_out * last))];
    high = values[std::size_t(std::ceil((1.0 - left_out) * last))];
  }

  void
  include(double value)
  {
    low = std::min(low, value);
    high = std::max(high, value);
  }

  double
  middle() const
  {
    return 0.5 * (low + high);
  }
};

// Camera axes as columns: right, down and forward.
Eigen::Matrix3d
axesOf(const Eigen::Vector3d& forward, const Eigen::Vector3d& right)
{
  Eigen::Matrix3d axes;
  axes << right, forward.cross(right), forward;
  return axes;
}

StereoCamera
pinhole(double focal_length, cv::Size size)
{
  if (size.width < 16 || size.height < 16 || size.width > 16384 || size.height > 16384)
    badParameter("a picture of ", size.width, " x ", size.height,
                 " pixels, expected 16 to 16384");
  StereoCamera camera;
  camera.fx = camera.fy = focal_length;
  camera.cx = 0.5 * (size.width - 1);
  camera.cy = 0.5 * (size.height - 1);
  camera.baseline = 1.0;
  camera.width = size.width;
  camera.height = size.height;
  return camera;
}

// Extent of a sample in the image, and the depth of its nearest part.
struct Extent {
  Range column, row;
  double nearest;
};

constexpr double kLeftOut = 0.015;

// The path must be inside completely.
Extent
extentOf(const SceneView& view, const std::vector<Eigen::Vector3d>& sample,
         const SensorPath& path)
{
  const Eigen::Isometry3d T_camera_world = view.T_world_camera.inverse();
  std::vector<double> columns, rows, depths;
  const auto add = [&](const Eigen::Vector3d& each) {
    const Eigen::Vector3d point = T_camera_world * each;
    depths.push_back(point.z());
    const Eigen::Vector2d pixel =
        view.camera.project({point.x(), point.y(), std::max(point.z(), 1e-3)});
    columns.push_back(pixel.x());
    rows.push_back(pixel.y());
  };
  for (const Eigen::Vector3d& each : sample)
    add(each);
  Extent extent{Range(columns, kLeftOut), Range(rows, 0.3 * kLeftOut),
                Range(depths, 0.002).low};
  for (const Eigen::Vector3d& each : path) {
    add(each);
    extent.column.include(columns.back());
    extent.row.include(rows.back());
    extent.nearest = std::min(extent.nearest, depths.back());
  }
  return extent;
}

bool
fits(const Extent& extent, cv::Size size)
{
  return extent.column.high - extent.column.low < 0.96 * size.width &&
         extent.row.high - extent.row.low < 0.92 * size.height;
}

} // namespace

SceneView
lookAt(const Eigen::Vector3d& from, const Eigen::Vector3d& target, double field_of_view,
       cv::Size size)
{
  if (!(field_of_view > 0.0 && field_of_view < kPi))
    badParameter("a field of view of ", field_of_view * 180.0 / kPi,
                 " degrees, expected 0 to 180");
  const Eigen::Vector3d way = target - from;
  if (!(way.norm() > 1e-9) || !way.allFinite())
    badParameter("the position to look from is the one to look at");
  const Eigen::Vector3d forward = way.normalized();
  Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ());
  if (right.norm() < 1e-6) // vertical view: the world's x points up in the image
    right = -Eigen::Vector3d::UnitY();
  SceneView view;
  view.camera = pinhole(0.5 * size.width / std::tan(0.5 * field_of_view), size);
  view.T_world_camera.linear() = axesOf(forward, right.normalized());
  view.T_world_camera.translation() = from;
  return view;
}

SceneView
angleView(const VoxelScene& scene, const SensorPath& path, cv::Size size)
{
  constexpr double elevation = 21.0 * kPi / 180.0, turn = 13.0 * kPi / 180.0;
  const std::vector<Eigen::Vector3d> sample = sampleOf(scene);
  // Slightly from the side, into the bend.
  const Eigen::Vector3d along = Eigen::AngleAxisd(bendsToTheRight(path) ? -turn : turn,
                                                  Eigen::Vector3d::UnitZ()) *
                                directionOf(sample, path);
  const Eigen::Vector3d forward =
      std::cos(elevation) * along - std::sin(elevation) * Eigen::Vector3d::UnitZ();
  Eigen::Vector3d centre;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Eigen::Vector3d& each : sample)
      values.push_back(each[axis]);
    centre[axis] = Range(values, kLeftOut).middle();
  }
  SceneView view;
  const auto setDistance = [&](double distance) {
    view = lookAt(centre - distance * forward, centre, 58.0 * kPi / 180.0, size);
    const Extent extent = extentOf(view, sample, path);
    // Shifts the principal point, which centres the map and keeps verticals upright.
    view.camera.cx += 0.5 * (size.width - 1) - extent.column.middle();
    view.camera.cy += 0.51 * (size.height - 1) - extent.row.middle();
    return extent.nearest > 0.15 * distance && fits(extent, size);
  };
  double low = 4.0 * scene.grid.size, high = low;
  while (!setDistance(high) && high < 1e8)
    high *= 2.0;
  for (int i = 0; i < 24; ++i) {
    const double middle = 0.5 * (low + high);
    (setDistance(middle) ? high : low) = middle;
  }
  setDistance(high);
  return view;
}

SceneView
aboveView(const VoxelScene& scene, const SensorPath& path, cv::Size size)
{
  const std::vector<Eigen::Vector3d> sample = sampleOf(scene);
  const Eigen::Vector3d right = directionOf(sample, path);
  const Eigen::Vector3d down = (-Eigen::Vector3d::UnitZ()).cross(right);
  std::vector<double> across, along, heights;
  for (const Eigen::Vector3d& each : sample) {
    along.push_back(right.dot(each));
    across.push_back(down.dot(each));
    heights.push_back(each.z());
  }
  Range x(along, kLeftOut), y(across, kLeftOut);
  const Range z(heights, 0.0);
  for (const Eigen::Vector3d& each : path) {
    x.include(right.dot(each));
    y.include(down.dot(each));
  }
  const double width = x.high - x.low + 2.0 * scene.grid.size,
               height = y.high - y.low + 2.0 * scene.grid.size;
  SceneView view;
  view.pixels_per_metre =
      std::min(0.96 * size.width / width, 0.9 * size.height / height);
  // A distance at which perspective is below a tenth of a pixel.
  const double distance = 1e5 * (width + height + z.high - z.low);
  view.camera = pinhole(view.pixels_per_metre * distance, size);
  view.T_world_camera.linear() = axesOf(-Eigen::Vector3d::UnitZ(), right);
  view.T_world_camera.translation() = x.middle() * right + y.middle() * down +
                                      (z.high + distance) * Eigen::Vector3d::UnitZ();
  return view;
}

} // namespace pcl_semantic
