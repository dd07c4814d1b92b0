// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/map/seen_through.h>

#include "core/cloud_size.h"
#include "core/fail.h"
#include "core/voxel_table.h"

#include <pcl_semantic/core/sensor_pose.h>
#include <pcl_semantic/core/voxel_index.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace pcl_semantic {

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZRGB>;

constexpr double smallest_gap = 0.5;   // between a voxel and a point behind it [m]
constexpr double sensor_height = 2.0;  // above the ground, for grazing rays [m]
constexpr double nearest_corner = 0.1; // of a cube that can be projected [m]
constexpr float farthest = 1e4f;       // beyond the range of stereo cameras [m]

struct HitVoxels {
  std::vector<VoxelIndex> voxels;
  std::vector<int> points;   // number of points in each
  std::vector<int> voxel_of; // for each point of the cloud; -1 = none
};

constexpr int none = -1;

// No voxel for points without depth or too far away.
std::vector<std::optional<VoxelIndex>>
voxelsOfPoints(const Cloud& cloud, const Eigen::Isometry3d& T_world_camera,
               double voxel_size)
{
  std::vector<std::optional<VoxelIndex>> voxels(cloud.size());
#pragma omp parallel for
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f point = cloud[i].getVector3fMap();
    if (point.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() < farthest) // false for NaN
      voxels[i] = voxelOf(quantize(T_world_camera * point.cast<double>(), voxel_size));
  }
  return voxels;
}

HitVoxels
findHitVoxels(const Cloud& cloud, const Eigen::Isometry3d& T_world_camera,
              double voxel_size)
{
  const auto voxels = voxelsOfPoints(cloud, T_world_camera, voxel_size);
  HitVoxels hit;
  hit.voxel_of.assign(cloud.size(), none);
  std::vector<VoxelIndex> runs; // deduplicated runs: neighbours in the image often
                                // share a voxel
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (voxels[i]) {
      if (runs.empty() || *voxels[i] != runs.back())
        runs.push_back(*voxels[i]);
      hit.voxel_of[i] = int(runs.size()) - 1;
    }
  const VoxelTable table(runs);
  std::vector<int> number_of(runs.size());
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const auto first = std::size_t(table.find(runs[r]));
    number_of[r] = first == r ? int(hit.voxels.size()) : number_of[first];
    if (first == r)
      hit.voxels.push_back(runs[r]);
  }
  hit.points.resize(hit.voxels.size());
  for (int& voxel : hit.voxel_of)
    if (voxel != none)
      ++hit.points[std::size_t(voxel = number_of[std::size_t(voxel)])];
  return hit;
}

/** \brief Pixels that a cube may cover; empty if it is behind the camera or too near.
 */
struct PixelBox {
  Eigen::Array2i first{0, 0}, last{-1, -1};
};

PixelBox
enclosingPixels(const VoxelIndex& voxel, double voxel_size, const StereoCamera& camera,
                const Eigen::Isometry3d& T_camera_world)
{
  Eigen::Array2d least = Eigen::Array2d::Constant(1e9), most = -least;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d offset(corner & 1, corner >> 1 & 1, corner >> 2);
    const Eigen::Vector3d point =
        T_camera_world * ((voxel.cast<double>() + offset) * voxel_size);
    if (point.z() < nearest_corner)
      return {};
    const Eigen::Array2d pixel = camera.project(point);
    least = least.min(pixel);
    most = most.max(pixel);
  }
  const Eigen::Array2d end(camera.width - 1, camera.height - 1);
  return {least.ceil().max(0.0).min(end + 1.0).cast<int>(),
          most.floor().min(end).max(-1.0).cast<int>()};
}

int
countBeyond(const Cloud& cloud, const PixelBox& pixels, float depth)
{
  int count = 0;
  for (int v = pixels.first.y(); v <= pixels.last.y(); ++v)
    for (int u = pixels.first.x(); u <= pixels.last.x(); ++u)
      count += cloud[std::size_t(v) * cloud.width + std::size_t(u)].z > depth;
  return count;
}

void
check(const Cloud& cloud, const StereoCamera& camera,
      const Eigen::Isometry3d& T_world_camera, double voxel_size, double fraction)
{
  requireCloudSize(cloud);
  if (int(cloud.width) != camera.width || int(cloud.height) != camera.height)
    badParameter("the cloud has ", cloud.width, " x ", cloud.height,
                 " points, expected the camera's ", camera.width, " x ", camera.height);
  if (!(voxel_size > 0.0 && std::isfinite(voxel_size)))
    badParameter("voxel_size is ", voxel_size, ", expected more than 0");
  if (!(fraction >= 0.0 && fraction <= 1.0))
    badParameter("fraction is ", fraction, ", expected 0 to 1");
  requireRigid(T_world_camera, "the pose of the camera");
}

} // namespace

std::size_t
eraseSeenThrough(Cloud& cloud, const StereoCamera& camera,
                 const Eigen::Isometry3d& T_world_camera, double voxel_size,
                 double fraction)
{
  check(cloud, camera, T_world_camera, voxel_size, fraction);
  const HitVoxels hit = findHitVoxels(cloud, T_world_camera, voxel_size);
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  std::vector<std::uint8_t> is_seen_through(hit.voxels.size());
#pragma omp parallel for schedule(dynamic, 256)
  for (std::size_t k = 0; k < hit.voxels.size(); ++k) {
    const PixelBox pixels =
        enclosingPixels(hit.voxels[k], voxel_size, camera, T_camera_world);
    const double z = (T_camera_world * centreOf(hit.voxels[k], voxel_size)).z();
    const double gap = smallest_gap + z * voxel_size / sensor_height;
    const int beyond = countBeyond(cloud, pixels, float(z + gap));
    is_seen_through[k] = hit.points[k] < fraction * (hit.points[k] + beyond);
  }
  std::size_t erased = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (hit.voxel_of[i] >= 0 && is_seen_through[std::size_t(hit.voxel_of[i])]) {
      cloud[i].getVector3fMap().setConstant(std::numeric_limits<float>::quiet_NaN());
      ++erased;
    }
  return erased;
}

} // namespace pcl_semantic
