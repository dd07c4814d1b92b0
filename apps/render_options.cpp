// SPDX-License-Identifier: BSD-3-Clause
#include "render_options.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/input_file.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic::tool {

namespace {

std::vector<double>
numbersOf(std::string text, char separator, std::size_t count, const char* option)
{
  std::replace(text.begin(), text.end(), separator, ' ');
  std::vector<double> numbers;
  try {
    numbers = parseNumbers(text, option);
  }
  catch (const BadInputException& error) {
    failUsage(error.what());
  }
  if (numbers.size() != count)
    failUsage(std::string(option) + " has " + std::to_string(numbers.size()) +
              " numbers, expected " + std::to_string(count));
  return numbers;
}

cv::Size
sizeOf(const std::string& text)
{
  const std::vector<double> sides = numbersOf(text, 'x', 2, "--size");
  for (const double side : sides)
    if (!(side >= 160.0 && side <= 8192.0 && side == std::floor(side)))
      failUsage("--size is " + text + ", expected WIDTHxHEIGHT from 160 to 8192");
  return {int(sides[0]), int(sides[1])};
}

Eigen::Vector3d
positionOf(const std::string& text, const char* option)
{
  const std::vector<double> position = numbersOf(text, ',', 3, option);
  return {position[0], position[1], position[2]};
}

} // namespace

std::vector<Option>
withRenderOptions(RenderOptions& options, std::vector<Option> first,
                  const std::vector<Option>& last)
{
  first.insert(
      first.end(),
      {{"trajectory", options.hints.trajectory,
        "trajectory to draw, KITTI or TUM (default: trajectory.txt of the folder)"},
       {"from", options.texts.from,
        "position of the view, X,Y,Z in the frame of the map [m]"},
       {"look-at", options.texts.look_at, "point to look at, X,Y,Z [m]"},
       {"label-set", options.hints.label_set,
        "label set (YAML; default: that of the archive, or label_sets/kitti11.yaml)"},
       {"voxel-size", options.hints.voxel_size,
        "voxel size [m] (default: that of the map, or of its points)"},
       {"view", withDefault(options.view),
        "angle (along the path from above), above, camera"},
       {"frame", withDefault(options.frame), "row of the trajectory for --view camera"},
       {"field-of-view", withDefault(options.texts.degrees),
        "horizontal field of view of --from and --view camera [degrees]"}});
  first.insert(first.end(), last.begin(), last.end());
  return first;
}

void
readRenderOptions(RenderOptions& options)
{
  options.size = sizeOf(options.texts.size);
  options.field_of_view = options.texts.degrees * M_PI / 180.0;
  refuseIf(options.texts.from.empty() != options.texts.look_at.empty(),
           "--from and --look-at belong together");
  options.looks_from = !options.texts.from.empty();
  if (options.looks_from) {
    options.from = positionOf(options.texts.from, "--from");
    options.look_at = positionOf(options.texts.look_at, "--look-at");
  }
  requireOneOf("--view", options.view, {"angle", "above", "camera"});
  refuseIf(!(options.hints.voxel_size >= 0.0), "--voxel-size is less than 0");
}

void
requireOneOf(const char* option, const std::string& value,
             const std::vector<std::string>& known)
{
  if (std::count(known.begin(), known.end(), value) > 0)
    return;
  std::string expected = known.front();
  for (std::size_t i = 1; i < known.size(); ++i)
    expected += (i + 1 < known.size() ? ", " : " or ") + known[i];
  failUsage(std::string(option) + " is '" + value + "', expected " + expected);
}

SceneView
viewOf(const RenderOptions& options, const VoxelScene& scene, const Trajectory& poses)
{
  const Eigen::Vector3d& corner = scene.grid.corner;
  if (options.looks_from)
    return lookAt(options.from - corner, options.look_at - corner,
                  options.field_of_view, options.size);
  if (options.view == "camera") {
    if (options.frame < 0 || std::size_t(options.frame) >= poses.size())
      badParameter("--view camera: the trajectory has ", poses.size(),
                   " poses, none for --frame ", options.frame);
    const Eigen::Isometry3d& pose = poses[std::size_t(options.frame)];
    return lookAt(pose.translation(), pose * Eigen::Vector3d::UnitZ(),
                  options.field_of_view, options.size);
  }
  return options.view == "above" ? aboveView(scene, pathOf(poses), options.size)
                                 : angleView(scene, pathOf(poses), options.size);
}

SensorPath
pathOf(const Trajectory& poses)
{
  SensorPath path;
  for (const Eigen::Isometry3d& pose : poses)
    path.push_back(pose.translation());
  return path;
}

} // namespace pcl_semantic::tool
