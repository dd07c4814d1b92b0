// SPDX-License-Identifier: BSD-3-Clause
#include "local_ground.h"

#include <pcl_semantic/core/exceptions.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

// The voxels of the ground's classes, from below.
std::vector<std::size_t>
groundVoxels(const VoxelScene& scene, const std::vector<Label>& classes)
{
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < scene.voxels.size(); ++i)
    if (std::count(classes.begin(), classes.end(), (*scene.voxels.cloud)[i].label) > 0)
      rows.push_back(i);
  std::sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) {
    return VoxelIndexLess()(scene.voxels.indices[a], scene.voxels.indices[b]);
  });
  return rows;
}

// Top of the lowest stretch of ground in each column, where there is one.
LocalGround
ownGround(const VoxelScene& scene, const VoxelColumns& columns,
          const std::vector<std::size_t>& rows)
{
  LocalGround ground{cv::Mat(columns.size(), CV_32F, cv::Scalar(kNone)),
                     cv::Mat::zeros(columns.size(), CV_8UC1)};
  for (const std::size_t row : rows) {
    const VoxelIndex& voxel = scene.voxels.indices[row];
    float& height = ground.height.at<float>(columns.pixelOf(voxel));
    const auto below = static_cast<float>(voxel.z() - columns.lower().z());
    if (!std::isnan(height) && height != below)
      continue;
    height = below + 1.0f;
    ground.label.at<std::uint8_t>(columns.pixelOf(voxel)) =
        static_cast<std::uint8_t>((*scene.voxels.cloud)[row].label);
  }
  return ground;
}

// Gives every column the height of the nearest one that has one, and smooths them.
cv::Mat
spread(const cv::Mat& height, const cv::Mat& label, float reach)
{
  cv::Mat distance, nearest;
  cv::distanceTransform(label == 0, distance, nearest, cv::DIST_L2, cv::DIST_MASK_5,
                        cv::DIST_LABEL_PIXEL);
  std::vector<float> height_of(std::size_t(label.total()) + 1, kNone);
  for (int v = 0; v < label.rows; ++v)
    for (int u = 0; u < label.cols; ++u)
      if (label.at<std::uint8_t>(v, u) != 0)
        height_of[std::size_t(nearest.at<int>(v, u))] = height.at<float>(v, u);
  cv::Mat filled(height.size(), CV_32F), smooth;
  for (int v = 0; v < label.rows; ++v)
    for (int u = 0; u < label.cols; ++u)
      filled.at<float>(v, u) = height_of[std::size_t(nearest.at<int>(v, u))];
  cv::medianBlur(filled, smooth, 5);
  smooth.setTo(cv::Scalar(kNone), distance > reach);
  return smooth;
}

} // namespace

VoxelColumns::VoxelColumns(const VoxelScene& scene)
    : lower_(VoxelIndex::Constant(std::numeric_limits<int>::max())),
      upper_(VoxelIndex::Constant(std::numeric_limits<int>::min()))
{
  constexpr double most = 1 << 28;
  for (const VoxelIndex& voxel : scene.voxels.indices) {
    lower_ = lower_.cwiseMin(voxel);
    upper_ = upper_.cwiseMax(voxel);
  }
  if (scene.voxels.size() == 0)
    PCL_THROW_EXCEPTION(BadInputException, "the map has no voxel");
  const Eigen::Array3d cells = (upper_ - lower_).cast<double>().array() + 1.0;
  if (cells.x() * cells.y() > most || cells.z() > most)
    PCL_THROW_EXCEPTION(BadInputException, "the map is "
                                               << cells.x() << " x " << cells.y()
                                               << " columns large, expected at most "
                                               << most << " in all");
}

LocalGround
findGround(const VoxelScene& scene, const VoxelColumns& columns,
           const OccupancyGridParameters& parameters)
{
  const std::vector<std::size_t> rows = groundVoxels(scene, parameters.ground);
  if (rows.empty())
    PCL_THROW_EXCEPTION(BadInputException,
                        "the map has no voxel of the classes of the ground");
  LocalGround ground = ownGround(scene, columns, rows);
  const cv::Mat own = ground.height;
  ground.height =
      spread(own, ground.label, static_cast<float>(parameters.reach / scene.grid.size));
  // Ground above or below that around it is none: a roof, or noise under the road.
  const auto most = static_cast<float>(parameters.min_height / scene.grid.size);
  ground.label.setTo(0, cv::abs(own - ground.height) > most);
  return ground;
}

} // namespace pcl_semantic
