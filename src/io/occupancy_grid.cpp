// SPDX-License-Identifier: BSD-3-Clause
#include "local_ground.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace pcl_semantic {

namespace {

void
requireHeights(const OccupancyGridParameters& parameters)
{
  if (!(parameters.min_height >= 0.0 && parameters.max_height > parameters.min_height &&
        std::isfinite(parameters.max_height)))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "the heights are " << parameters.min_height << " and "
                                           << parameters.max_height
                                           << " m, expected 0 <= lower < upper");
  if (!(parameters.reach >= 0.0))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "the reach of the ground is " << parameters.reach << " m");
}

// Of each column, whether one of the voxels lies between the heights above the ground.
cv::Mat
betweenHeights(const std::vector<VoxelIndex>& voxels, const VoxelScene& scene,
               const VoxelColumns& columns, const LocalGround& ground,
               const OccupancyGridParameters& parameters)
{
  cv::Mat found = cv::Mat::zeros(columns.size(), CV_8UC1);
  for (const VoxelIndex& voxel : voxels) {
    if (!columns.contains(voxel))
      continue;
    const cv::Point pixel = columns.pixelOf(voxel);
    const double centre = double(voxel.z()) - columns.lower().z() + 0.5;
    const double above = (centre - ground.height.at<float>(pixel)) * scene.grid.size;
    if (above >= parameters.min_height && above < parameters.max_height)
      found.at<std::uint8_t>(pixel) = 255; // never where there is no ground: NaN
  }
  return found;
}

OccupancyGrid
emptyGrid(const VoxelScene& scene, const VoxelColumns& columns)
{
  OccupancyGrid grid;
  grid.cells = cv::Mat(columns.size(), CV_8UC1, cv::Scalar(OccupancyGrid::kUnknown));
  grid.resolution = scene.grid.size;
  grid.origin = (scene.grid.corner + scene.origin +
                 columns.lower().cast<double>() * scene.grid.size)
                    .head<2>();
  return grid;
}

} // namespace

OccupancyGrid
occupancyGrid(const VoxelScene& scene, const OccupancyGridParameters& parameters)
{
  requireHeights(parameters);
  const VoxelColumns columns(scene);
  const LocalGround ground = findGround(scene, columns, parameters);
  OccupancyGrid grid = emptyGrid(scene, columns);
  const cv::Mat is_free =
      scene.knows_free ? betweenHeights(scene.free, scene, columns, ground, parameters)
                       : cv::Mat(ground.label != 0);
  grid.cells.setTo(OccupancyGrid::kFree, is_free);
  grid.cells.setTo(
      OccupancyGrid::kOccupied,
      betweenHeights(scene.voxels.indices, scene, columns, ground, parameters));
  return grid;
}

OccupancyGrid
traversabilityGrid(const VoxelScene& scene, const OccupancyGridParameters& parameters)
{
  requireHeights(parameters);
  const VoxelColumns columns(scene);
  const LocalGround ground = findGround(scene, columns, parameters);
  OccupancyGrid grid = emptyGrid(scene, columns);
  grid.cells.setTo(OccupancyGrid::kOccupied, ground.label != 0);
  for (const Label label : parameters.traversable)
    if (label != kUnlabelled)
      grid.cells.setTo(OccupancyGrid::kFree, ground.label == label);
  grid.cells.setTo(
      OccupancyGrid::kOccupied,
      betweenHeights(scene.voxels.indices, scene, columns, ground, parameters));
  return grid;
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
  // As map_saver writes them: 205 is then unknown.
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
