// SPDX-License-Identifier: BSD-3-Clause
#include "view_of_map.h"
#include "view_panel.h"

#include <pcl_semantic/core/exceptions.h>

#include <cmath>
#include <filesystem>

namespace pcl_semantic::tool {

namespace {

constexpr std::size_t kMaxImages = 12;

// A view of a map as a whole, so that the panel does not lie on it.
SceneView
besidePanel(const std::string& name, RenderOptions options, const VoxelScene& scene,
            const Trajectory& poses)
{
  const int panel = options.size.width > 3 * kPanelWidth ? kPanelWidth : 0;
  options.looks_from = false;
  options.view = name;
  options.size.width -= panel;
  SceneView view = viewOf(options, scene, poses);
  view.camera.width += panel;
  view.camera.cx += panel;
  return view;
}

// The view that was asked for, and those that are always there.
std::vector<SceneView>
viewsOf(const RenderOptions& options, const VoxelScene& scene, const Trajectory& poses)
{
  std::vector<SceneView> views;
  if (options.looks_from || options.view == "camera")
    views.push_back(viewOf(options, scene, poses));
  else if (options.view == "above")
    views.push_back(besidePanel("above", options, scene, poses));
  views.push_back(besidePanel("angle", options, scene, poses));
  views.push_back(besidePanel("above", options, scene, poses));
  if (poses.empty())
    return views;
  RenderOptions last = options;
  last.looks_from = false;
  last.view = "camera";
  last.frame = int(poses.size()) - 1;
  views.push_back(viewOf(last, scene, poses));
  return views;
}

// Where the camera is now, seen from behind it.
SceneView
behindCamera(const ViewedMap& map, const ViewArguments& arguments)
{
  const Eigen::Isometry3d& pose = map.path.back();
  const Eigen::Vector3d behind = pose * Eigen::Vector3d(0.0, -6.0, -10.0),
                        ahead = pose * Eigen::Vector3d(0.0, 1.0, 12.0);
  return lookAt(behind - map.grid.corner, ahead - map.grid.corner, 60.0 * M_PI / 180.0,
                arguments.picture.size);
}

std::set<Label>
labelsOf(const std::vector<std::string>& names, const LabelSet& label_set)
{
  std::set<Label> labels;
  for (const std::string& name : names) {
    const Label label = label_set.find(name);
    if (label == kUnlabelled && name != label_set[kUnlabelled].name)
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "--hide: no class is called '" << name << "'");
    labels.insert(label);
  }
  return labels;
}

} // namespace

OpenedMap
openMap(const ViewArguments& arguments)
{
  const MapInput input = readMap(arguments.map, arguments.picture.hints);
  OpenedMap opened;
  opened.views = viewsOf(arguments.picture, input.scene, posesInScene(input));
  opened.map = viewedMap(input.scene, input.label_set, arguments.map);
  opened.map.path = input.T_world_camera;
  for (Eigen::Isometry3d& pose : opened.map.path)
    pose.translation() -= input.scene.origin;
  opened.state.hidden = labelsOf(arguments.hide, input.label_set);
  opened.state.below = arguments.below;
  opened.state.above = arguments.above;
  if (!arguments.colour.empty())
    opened.state.colouring = colouringOf(opened.map, arguments.colour);
  if (!arguments.images.empty()) {
    if (opened.map.path.empty())
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "--images: where the camera was is not known; name its "
                          "--trajectory");
    opened.map.pictures =
        imagesOf(arguments.images, opened.map.path, arguments.follow ? 1 : kMaxImages);
    opened.state.pictures = true;
  }
  const std::filesystem::path path(arguments.map);
  opened.map.title =
      (path.has_filename() ? path : path.parent_path()).filename().string();
  return opened;
}

FollowedMap::FollowedMap(const ViewArguments& arguments, MapViewer& viewer)
    : arguments_(arguments), viewer_(viewer), folder_(arguments.map)
{}

void
FollowedMap::update()
{
  for (const std::string& folder : {folder_ + "/live", folder_}) {
    std::error_code error;
    const auto written =
        std::filesystem::last_write_time(folder + "/summary.json", error);
    if (error)
      continue;
    if (written == shown_)
      return;
    shown_ = written;
    arguments_.map = folder;
    try {
      show(openMap(arguments_));
    }
    catch (const BadInputException&) {
      // Nothing to look at yet, or on its way from one frame to the next.
    }
    return;
  }
}

void
FollowedMap::show(OpenedMap opened)
{
  if (!opened.map.path.empty()) {
    opened.views.insert(opened.views.begin(), behindCamera(opened.map, arguments_));
    const Eigen::Vector3d position = opened.map.path.back().translation();
    if (!is_first_) // it comes along
      viewer_.move(position - last_position_);
    last_position_ = position;
  }
  if (is_first_)
    viewer_.state() = opened.state;
  viewer_.show(std::move(opened.map), std::move(opened.views));
  if (is_first_)
    for (const std::string& key : arguments_.keys)
      viewer_.press(key);
  is_first_ = false;
}

} // namespace pcl_semantic::tool
