// SPDX-License-Identifier: BSD-3-Clause
#include "view_of_map.h"

#include "view_panel.h"

#include <pcl_semantic/core/exceptions.h>

#include <filesystem>

namespace pcl_semantic::tool {

namespace {

constexpr std::size_t kMostPictures = 12;

// A view of a map as a whole, so that the panel does not lie on it.
PictureView
besidePanel(const std::string& name, PictureOptions options, const VoxelScene& scene,
            const Trajectory& poses)
{
  const int panel = options.size.width > 3 * kPanelWidth ? kPanelWidth : 0;
  options.looks_from = false;
  options.view = name;
  options.size.width -= panel;
  PictureView view = viewOf(options, scene, poses);
  view.camera.width += panel;
  view.camera.cx += panel;
  return view;
}

// The view that was asked for, and those that are always there.
std::vector<PictureView>
viewsOf(const PictureOptions& options, const VoxelScene& scene, const Trajectory& poses)
{
  std::vector<PictureView> views;
  if (options.looks_from || options.view == "camera")
    views.push_back(viewOf(options, scene, poses));
  else if (options.view == "above")
    views.push_back(besidePanel("above", options, scene, poses));
  views.push_back(besidePanel("angle", options, scene, poses));
  views.push_back(besidePanel("above", options, scene, poses));
  if (poses.empty())
    return views;
  PictureOptions last = options;
  last.looks_from = false;
  last.view = "camera";
  last.frame = int(poses.size()) - 1;
  views.push_back(viewOf(last, scene, poses));
  return views;
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
    opened.map.pictures = picturesOf(arguments.images, opened.map.path, kMostPictures);
    opened.state.pictures = true;
  }
  const std::filesystem::path path(arguments.map);
  opened.map.title =
      (path.has_filename() ? path : path.parent_path()).filename().string();
  return opened;
}

} // namespace pcl_semantic::tool
