// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pictures/occupancy_grid.h>

#include "core/fail.h"
#include "core/label_number.h"

#include <pcl_semantic/files/atomic_file.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include <yaml-cpp/yaml.h>

namespace pcl_semantic {

namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

void
requireHeights(const OccupancyGridParameters& parameters)
{
  if (!(parameters.min_height >= 0.0 && parameters.max_height > parameters.min_height &&
        std::isfinite(parameters.max_height)))
    badParameter("the heights are ", parameters.min_height, " and ",
                 parameters.max_height, " m, expected 0 <= lower < upper");
  if (!(parameters.reach >= 0.0))
    badParameter("the reach of the ground is ", parameters.reach, " m");
}

Eigen::AlignedBox3i
boxOf(const VoxelScene& scene)
{
  constexpr double max_cells = 1 << 28;
  Eigen::AlignedBox3i box;
  for (const VoxelIndex& voxel : scene.voxels.indices)
    box.extend(voxel);
  if (box.isEmpty())
    badInput("the map has no voxel");
  const Eigen::Array3d cells = box.sizes().cast<double>().array() + 1.0;
  if (cells.x() * cells.y() > max_cells || cells.z() > max_cells)
    badInput("the map is ", cells.x(), " x ", cells.y(),
             " columns large, expected at most ", max_cells, " in all");
  return box;
}

// Assigns to every column the height of the nearest known one, and smooths the heights.
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

// A grid of the columns of a scene, and the data that classify them as free or
// occupied.
class GridMaker {
public:
  GridMaker(const VoxelScene& scene, const OccupancyGridParameters& parameters)
      : scene_(scene), parameters_((requireHeights(parameters), parameters)),
        box_(boxOf(scene))
  {
    const Eigen::Vector3i sizes = box_.sizes();
    const cv::Size size(sizes.x() + 1, sizes.y() + 1);
    grid.cells = cv::Mat(size, CV_8UC1, cv::Scalar(OccupancyGrid::kUnknown));
    grid.resolution = scene.grid.size;
    grid.origin =
        (scene.grid.corner + scene.origin + box_.min().cast<double>() * scene.grid.size)
            .head<2>();
    findGround();
  }

  // For each column, whether a voxel is between the heights above ground.
  cv::Mat
  betweenHeights(const std::vector<VoxelIndex>& voxels) const
  {
    cv::Mat found = cv::Mat::zeros(grid.cells.size(), CV_8UC1);
    const cv::Rect inside(cv::Point(), found.size());
    for (const VoxelIndex& voxel : voxels) {
      const cv::Point pixel = pixelOf(voxel);
      if (!inside.contains(pixel))
        continue;
      const double centre = double(voxel.z()) - box_.min().z() + 0.5;
      const double above = (centre - height_.at<float>(pixel)) * scene_.grid.size;
      if (above >= parameters_.min_height && above < parameters_.max_height)
        found.at<std::uint8_t>(pixel) = 255; // false without ground: NaN
    }
    return found;
  }

  OccupancyGrid grid; // initially unknown
  cv::Mat label;      // CV_8UC1: class of the column's own ground, 0 = none

private:
  cv::Point
  pixelOf(const VoxelIndex& voxel) const
  {
    return {voxel.x() - box_.min().x(), box_.max().y() - voxel.y()};
  }

  void
  findGround()
  {
    cv::Mat own(grid.cells.size(), CV_32F, cv::Scalar(kNone));
    label = cv::Mat::zeros(own.size(), CV_8UC1);
    const std::vector<std::size_t> rows = groundVoxels();
    if (rows.empty())
      badInput("the map has no voxel of the classes of the ground");
    // The top of the lowest run of ground in each column.
    for (const std::size_t row : rows) {
      const VoxelIndex& voxel = scene_.voxels.indices[row];
      float& height = own.at<float>(pixelOf(voxel));
      const auto below = static_cast<float>(voxel.z() - box_.min().z());
      if (!std::isnan(height) && height != below)
        continue;
      height = below + 1.0f;
      label.at<std::uint8_t>(pixelOf(voxel)) =
          requireLabel((*scene_.voxels.cloud)[row].label);
    }
    height_ = spread(own, label, float(parameters_.reach / scene_.grid.size));
    // Ground far above or below its surroundings is rejected: a roof, or noise below
    // the road.
    const auto max_step = float(parameters_.min_height / scene_.grid.size);
    label.setTo(0, cv::abs(own - height_) > max_step);
  }

  // The voxels of ground classes, in ascending order of height.
  std::vector<std::size_t>
  groundVoxels() const
  {
    const std::vector<Label>& classes = parameters_.ground;
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < scene_.voxels.size(); ++i)
      if (std::count(classes.begin(), classes.end(), (*scene_.voxels.cloud)[i].label))
        rows.push_back(i);
    std::sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) {
      return VoxelIndexLess()(scene_.voxels.indices[a], scene_.voxels.indices[b]);
    });
    return rows;
  }

  const VoxelScene& scene_;
  const OccupancyGridParameters& parameters_;
  const Eigen::AlignedBox3i box_; // of the voxels
  cv::Mat height_; // CV_32F: voxels below the top of the ground; NaN = no ground
};

} // namespace

OccupancyGrid
occupancyGrid(const VoxelScene& scene, const OccupancyGridParameters& parameters)
{
  GridMaker maker(scene, parameters);
  cv::Mat& cells = maker.grid.cells;
  cells.setTo(OccupancyGrid::kFree, scene.knows_free ? maker.betweenHeights(scene.free)
                                                     : cv::Mat(maker.label != 0));
  cells.setTo(OccupancyGrid::kOccupied, maker.betweenHeights(scene.voxels.indices));
  return maker.grid;
}

std::string
gridDescription(const std::string& path)
{
  return std::filesystem::path(path).replace_extension(".yaml").string();
}

void
writeOccupancyGrid(const std::string& path, const OccupancyGrid& grid)
{
  YAML::Emitter yaml;
  yaml.SetDoublePrecision(15);
  yaml << YAML::BeginMap;
  yaml << YAML::Key << "image" << YAML::Value
       << std::filesystem::path(path).filename().string();
  yaml << YAML::Key << "resolution" << YAML::Value << grid.resolution;
  yaml << YAML::Key << "origin" << YAML::Value << YAML::Flow
       << std::vector<double>{grid.origin.x(), grid.origin.y(), 0.0};
  yaml << YAML::Key << "negate" << YAML::Value << 0;
  // As written by map_saver; 205 then means unknown.
  yaml << YAML::Key << "occupied_thresh" << YAML::Value << 0.65;
  yaml << YAML::Key << "free_thresh" << YAML::Value << 0.196;
  yaml << YAML::EndMap;

  AtomicFile image(path), description(gridDescription(path));
  image.stream() << "P5\n" << grid.cells.cols << " " << grid.cells.rows << "\n255\n";
  for (int row = 0; row < grid.cells.rows; ++row)
    image.stream().write(grid.cells.ptr<char>(row), grid.cells.cols);
  description.stream() << yaml.c_str() << "\n";
  image.commit();
  description.commit();
}

} // namespace pcl_semantic
