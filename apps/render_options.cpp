// SPDX-License-Identifier: BSD-3-Clause
#include "render_options.h"

#include <algorithm>
#include <cmath>

namespace pcl_semantic::tool {

namespace {

cv::Size
sizeOf(const std::string& text)
{
  std::string spaced = text;
  std::replace(spaced.begin(), spaced.end(), 'x', ' ');
  const std::vector<double> sides = parseNumbersOf("--size", spaced);
  bool are_good = sides.size() == 2;
  for (const double side : sides)
    are_good = are_good && side >= 160.0 && side <= 8192.0 && side == std::floor(side);
  refuseIf(!are_good, "--size is " + text + ", expected WIDTHxHEIGHT from 160 to 8192");
  return {int(sides[0]), int(sides[1])};
}

Eigen::Vector3d
positionOf(const std::string& text, const char* option)
{
  const std::vector<double> position = parseNumbersOf(option, text);
  refuseIf(position.size() != 3, std::string(option) + " has " +
                                     std::to_string(position.size()) +
                                     " numbers, expected 3");
  return {position[0], position[1], position[2]};
}

constexpr double field_of_view = 60.0 * M_PI / 180.0; // over the width [rad]

} // namespace

const std::vector<std::pair<std::string, std::string>> removed_render_options = {
    {"small", "any image program makes a PNG smaller"},
    {"field-of-view", "it is 60 degrees; a position nearer or farther shows more"}};

std::vector<Option>
withRenderOptions(RenderOptions& options, std::vector<Option> first,
                  const std::vector<Option>& last)
{
  first.insert(
      first.end(),
      {{"trajectory", options.hints.trajectory,
        "trajectory to draw, KITTI or TUM (default: trajectory.txt of the folder)"},
       {"objects", options.objects,
        "objects whose boxes are drawn (.json), or none (default: objects.json of the "
        "folder)"},
       {"planes", options.planes,
        "planes whose outlines are drawn (.json), such as planes.json of the folder"},
       {"from", options.texts.from,
        "position of the view, X,Y,Z in the frame of the map [m]"},
       {"look-at", options.texts.look_at, "point to look at, X,Y,Z [m]"},
       {"label-set", options.hints.label_set,
        "label set (YAML; default: that of the archive, or label_sets/kitti11.yaml)"},
       {"voxel-size", options.hints.voxel_size,
        "voxel size [m] (default: that of the map, or of its points)"},
       {"view", withDefault(options.view),
        "view: angle (along the path from above), above or camera"},
       {"frame", withDefault(options.frame),
        "row of the trajectory for --view camera"}});
  first.insert(first.end(), last.begin(), last.end());
  return first;
}

void
readRenderOptions(const po::variables_map& values, RenderOptions& options)
{
  options.size = sizeOf(options.texts.size);
  refuseIf(options.texts.from.empty() != options.texts.look_at.empty(),
           "--from and --look-at belong together");
  options.looks_from = !options.texts.from.empty();
  if (options.looks_from) {
    options.from = positionOf(options.texts.from, "--from");
    options.look_at = positionOf(options.texts.look_at, "--look-at");
  }
  refuseIf(options.view != "angle" && options.view != "above" &&
               options.view != "camera",
           "--view is '" + options.view + "', expected angle, above or camera");
  refuseUnread(values,
               {{options.looks_from, "with --from", {"view", "frame"}},
                {options.view != "camera", "without --view camera", {"frame"}}});
  refuseIf(!(options.hints.voxel_size >= 0.0), "--voxel-size is less than 0");
}

void
requireColour(const std::string& colour)
{
  refuseIf(
      colour != "class" && colour != "rgb" && colour != "entropy",
      "--colour is '" + colour +
          "', expected class, rgb or entropy (changes: pcl_semantic_render --compare; "
          "other fields: pcl_viewer)");
}

SceneView
viewOf(const RenderOptions& options, const VoxelScene& scene, const Trajectory& poses)
{
  const Eigen::Vector3d& corner = scene.grid.corner;
  if (options.looks_from)
    return lookAt(options.from - corner, options.look_at - corner, field_of_view,
                  options.size);
  if (options.view == "camera") {
    if (options.frame < 0 || std::size_t(options.frame) >= poses.size())
      badParameter("--view camera: the trajectory has ", poses.size(),
                   " poses, none for --frame ", options.frame);
    const Eigen::Isometry3d& pose = poses[std::size_t(options.frame)];
    return lookAt(pose.translation(), pose * Eigen::Vector3d::UnitZ(), field_of_view,
                  options.size);
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
