// SPDX-License-Identifier: BSD-3-Clause
#include "view_of_map.h"

#include "live_frames.h"
#include "view_panel.h"

#include <pcl_semantic/core/exceptions.h>

#include <cmath>
#include <filesystem>
#include <iostream>
#include <mutex>
#include <thread>

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

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

// What the reading thread and the window have in common.
struct LiveShow::Inbox {
  std::mutex mutex;
  std::optional<ViewedMap> newest;
  std::thread reader;
};

LiveShow::LiveShow(const ViewArguments& arguments, MapViewer& viewer)
    : arguments_(arguments), viewer_(viewer), inbox_(std::make_shared<Inbox>())
{
  viewer.state().pictures = true;
}

LiveShow::~LiveShow()
{
  if (!inbox_->reader.joinable())
    return;
  // The reader may wait for a frame; only a socket can be told to give up.
  if (shutdown(STDIN_FILENO, SHUT_RDWR) == 0)
    inbox_->reader.join();
  else
    inbox_->reader.detach();
}

void
LiveShow::sayReady()
{
  std::cout << "ready" << std::endl;
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  close(nowhere);
  inbox_->reader = std::thread([inbox = inbox_] {
    try {
      while (std::optional<ViewedMap> map = readViewedMap(stdin)) {
        const std::lock_guard<std::mutex> lock(inbox->mutex);
        inbox->newest = std::move(map);
      }
    }
    catch (const BadInputException&) {
      // Who sends was killed: what has come stays on the screen.
    }
  });
}

void
LiveShow::showNewest()
{
  std::optional<ViewedMap> newest;
  {
    const std::lock_guard<std::mutex> lock(inbox_->mutex);
    newest.swap(inbox_->newest);
  }
  if (newest)
    show(std::move(*newest));
}

void
LiveShow::showLast()
{
  std::optional<ViewedMap> last;
  while (std::optional<ViewedMap> map = readViewedMap(stdin))
    last = std::move(map);
  if (!last)
    PCL_THROW_EXCEPTION(BadInputException, "standard input: has no map");
  show(std::move(*last));
}

void
LiveShow::show(ViewedMap map)
{
  if (map.indices.empty())
    return; // nothing to look at yet
  std::vector<PictureView> views = viewsOf(map);
  if (!map.path.empty()) {
    const Eigen::Vector3d place = map.path.back().translation();
    if (!is_first_) // it comes along
      viewer_.move(place - last_place_);
    last_place_ = place;
  }
  viewer_.show(std::move(map), std::move(views));
  if (is_first_)
    for (const std::string& key : arguments_.keys)
      viewer_.press(key);
  is_first_ = false;
}

// From behind the camera, and the map as a whole.
std::vector<PictureView>
LiveShow::viewsOf(const ViewedMap& map) const
{
  const cv::Size size = arguments_.picture.size;
  VoxelScene scene;
  scene.grid = map.grid;
  scene.voxels.indices = map.indices;
  SensorPath path = pathOf(map.path);
  for (Eigen::Vector3d& place : path)
    place -= map.grid.corner;
  std::vector<PictureView> views;
  if (!map.path.empty()) {
    const Eigen::Isometry3d& pose = map.path.back();
    const Eigen::Vector3d behind = pose * Eigen::Vector3d(0.0, -6.0, -10.0),
                          ahead = pose * Eigen::Vector3d(0.0, 1.0, 12.0);
    views.push_back(lookAt(behind - map.grid.corner, ahead - map.grid.corner,
                           60.0 * M_PI / 180.0, size));
  }
  views.push_back(angleView(scene, path, size));
  views.push_back(aboveView(scene, path, size));
  return views;
}

} // namespace pcl_semantic::tool
