// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/evaluation/voxel_lookup.h>

#include "core/cloud_size.h"
#include "core/fail.h"
#include "core/label_number.h"
#include "map/ray_traversal.h"
#include "pictures/splat_renderer.h"

#include <pcl_semantic/core/sensor_pose.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

// Visits the indices of a box, both corners included, by z, y, x.
template <typename Visit>
void
visitBox(const VoxelIndex& first, const VoxelIndex& last, const Visit& visit)
{
  VoxelIndex index;
  for (index.z() = first.z(); index.z() <= last.z(); ++index.z())
    for (index.y() = first.y(); index.y() <= last.y(); ++index.y())
      for (index.x() = first.x(); index.x() <= last.x(); ++index.x())
        visit(index);
}

bool
isNear(const Eigen::Vector3d& point, double voxel_size)
{
  return (point.array().abs() < (kMaxVoxelIndex - 1) * voxel_size).all(); // false for
                                                                          // NaN
}

VoxelIndex
indexOf(const Eigen::Vector3d& point, double voxel_size)
{
  return voxelOf(quantize(point, voxel_size));
}

// From a point to the cube of a voxel.
double
squaredDistance(const Eigen::Vector3d& point, const VoxelIndex& index,
                double voxel_size)
{
  const Eigen::Vector3d lower = index.cast<double>() * voxel_size;
  const Eigen::Vector3d upper = lower.array() + voxel_size;
  return (point - point.cwiseMax(lower).cwiseMin(upper)).squaredNorm();
}

Label
labelAt(std::int32_t index, const std::vector<Label>& labels)
{
  return index == VoxelLookup::none ? kUnlabelled : labels[std::size_t(index)];
}

} // namespace

VoxelLookup::VoxelLookup(const VoxelCloud& voxels) : voxel_size_(voxels.voxel_size)
{
  indices_.reserve(voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    indices_.emplace(voxels.indices[i], static_cast<std::int32_t>(i));
    blocks_.insert(blockOf(voxels.indices[i]));
  }
}

std::int32_t
VoxelLookup::find(const VoxelIndex& index) const
{
  const auto found = indices_.find(index);
  return found == indices_.end() ? none : found->second;
}

std::int32_t
VoxelLookup::at(const Eigen::Vector3d& point) const
{
  return isNear(point, voxel_size_) ? find(indexOf(point, voxel_size_)) : none;
}

std::int32_t
VoxelLookup::nearest(const Eigen::Vector3d& point, double within) const
{
  const std::int32_t index = at(point);
  if (index != none || !(within > 0.0) || !isNear(point, voxel_size_))
    return index;
  const VoxelIndex first = indexOf(point.array() - within, voxel_size_);
  const VoxelIndex last = indexOf(point.array() + within, voxel_size_);
  double least = std::nextafter(within * within, 1e300);
  VoxelIndex best = VoxelIndex::Constant(std::numeric_limits<int>::max());
  visitBox(blockOf(first), blockOf(last), [&](const VoxelIndex& block) {
    if (blocks_.count(block)) // most blocks are empty
      nearestInBlock(
          point, first.cwiseMax(block * kBlockEdge),
          last.cwiseMin(block * kBlockEdge + VoxelIndex::Constant(kBlockEdge - 1)),
          least, best);
  });
  return find(best);
}

void
VoxelLookup::nearestInBlock(const Eigen::Vector3d& point, const VoxelIndex& first,
                            const VoxelIndex& last, double& least,
                            VoxelIndex& best) const
{
  visitBox(first, last, [&](const VoxelIndex& index) {
    const double squared = squaredDistance(point, index, voxel_size_);
    if (squared > least || (squared == least && !VoxelIndexLess()(index, best)) ||
        find(index) == none)
      return;
    least = squared;
    best = index;
  });
}

std::vector<std::int32_t>
VoxelLookup::indices(const std::vector<Eigen::Vector3d>& points, double within) const
{
  std::vector<std::int32_t> result(points.size(), none);
#pragma omp parallel for schedule(dynamic, 1024)
  for (std::size_t i = 0; i < points.size(); ++i)
    result[i] = nearest(points[i], within);
  return result;
}

MapLabels::MapLabels(const VoxelCloud& voxels) : lookup(voxels)
{
  measured.reserve(voxels.size());
  refined.reserve(voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    measured.push_back(voxels.measured.mapLabel(Eigen::Index(i)));
    refined.push_back(requireLabel(voxels.cloud->points[i].label));
  }
  objects = voxels.objects;
}

std::vector<Label>
labelsAt(const std::vector<std::int32_t>& indices, const std::vector<Label>& labels)
{
  std::vector<Label> result(indices.size());
  std::transform(indices.begin(), indices.end(), result.begin(),
                 [&](std::int32_t index) { return labelAt(index, labels); });
  return result;
}

cv::Mat
labelsAt(const cv::Mat& indices, const std::vector<Label>& labels)
{
  cv::Mat1b result(indices.size());
  std::transform(indices.begin<std::int32_t>(), indices.end<std::int32_t>(),
                 result.begin(),
                 [&](std::int32_t index) { return labelAt(index, labels); });
  return result;
}

cv::Mat
labelsAtDepth(const SemanticVoxelMap& map,
              const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
              const Eigen::Isometry3d& T_world_camera, double max_depth)
{
  requireRigid(T_world_camera, "the pose of the camera");
  requireCloudSize(cloud);
  if (!cloud.isOrganized())
    badParameter("looking labels up at depth needs an organized cloud");
  const int width = static_cast<int>(cloud.width);
  const int height = static_cast<int>(cloud.height);
  cv::Mat labels = cv::Mat::zeros(height, width, CV_8UC1);
  std::vector<Eigen::Vector3d> points;
  std::vector<std::size_t> pixels;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud[i].z <= max_depth) { // false for NaN
      points.push_back(T_world_camera * cloud[i].getVector3fMap().cast<double>());
      pixels.push_back(i);
    }
  const std::vector<Label> found = map.labels(points);
  for (std::size_t i = 0; i < found.size(); ++i)
    labels.data[pixels[i]] = found[i];
  return labels;
}

RenderedLabels
renderLabels(const VoxelCloud& voxels, const StereoCamera& camera,
             const Eigen::Isometry3d& T_world_camera, double max_depth)
{
  requireRigid(T_world_camera, "the pose of the camera");
  if (!voxels.cloud || voxels.cloud->size() != voxels.size())
    badParameter("the voxels have ", voxels.size(), " indices, their cloud ",
                 (voxels.cloud ? voxels.cloud->size() : 0), " points");
  const SplatImage splats = renderSplats(voxels, camera, T_world_camera, max_depth);
  return {splats.label, splats.depth, splats.voxel};
}

} // namespace pcl_semantic
