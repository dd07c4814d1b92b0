// SPDX-License-Identifier: BSD-3-Clause
#include "display.h"
#include "map_viewer.h"
#include "messages.h"
#include "render_options.h"
#include "view_panel.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/plane_file.h>
#include <pcl_semantic/images/image_file.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <set>

#ifdef __SANITIZE_ADDRESS__
// A software renderer leaks 112 bytes. It is unloaded before leaks are counted, so a
// suppression by name is impossible.
extern "C" const char*
__asan_default_options()
{
  return "detect_leaks=0";
}
#endif

namespace {

using namespace pcl_semantic;

using tool::MapViewer;
using tool::RenderOptions;

struct Arguments {
  std::string map, screenshot;
  std::string colour;            ///< empty = the map's first
  std::vector<std::string> hide; ///< names of classes
  std::string images;            ///< a sequence; empty = none
  std::vector<std::string> keys; ///< pressed at the start
  tool::ViewState state;         ///< with the ceiling
  bool follow = false;           ///< the map is growing
  int threads = 0;
  RenderOptions picture;
};

tool::Usage
usageOfView()
{
  std::string keys;
  for (const std::string& line : tool::helpOnKeys())
    keys += "\n  " + line;
  return {
      "pcl_semantic_view",
      "MAP [options]",
      "Shows a labelled map in a window. MAP is a folder that pcl_semantic_map has\n"
      "written, a .pcd or .ply, or a map archive. --screenshot writes what the window "
      "would\n"
      "show and ends; it needs no display. Keys:" +
          keys,
      "pcl_semantic_synthesize /tmp/street && \\\n"
      "  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output "
      "/tmp/map && \\\n"
      "  pcl_semantic_view /tmp/map --hide vegetation --screenshot /tmp/view.png",
      {{"screenshot FILE", "write a picture (.png) instead of opening a window"},
       {"colour WORD", "class, rgb or entropy"},
       {"hide NAMES", "names of classes to hide, separated by commas"},
       {"below 2.5", "show only what is below this height [m]"},
       {"images SEQUENCE", "sequence whose images are shown"},
       {"trajectory FILE", "trajectory to draw, KITTI or TUM"},
       {"follow", "show MAP while pcl_semantic_map --view writes it"},
       {"view angle", "angle, above or camera"}}};
}

Arguments
parse(int argc, char** argv)
{
  std::vector<std::pair<std::string, std::string>> removed =
      tool::removed_render_options;
  removed.emplace_back("above", "--below shows what lies under a height");
  tool::refuseRemoved(argc, argv, removed);
  Arguments arguments;
  std::string hide, keys;
  const auto values = tool::parseCommandLine(
      argc, argv, usageOfView(),
      tool::withRenderOptions(
          arguments.picture,
          {{"map", arguments.map, "input map"},
           {"screenshot", arguments.screenshot,
            "write a picture (.png) instead of opening a window"},
           {"colour", arguments.colour,
            "colour of voxels: class, rgb or entropy (default: the first that MAP "
            "has)"},
           {"hide", hide, "names of classes to hide, separated by commas"},
           {"below", arguments.state.below, "show only what is below this height [m]"},
           {"images", arguments.images,
            "sequence (KITTI's layout) whose images are shown at the camera positions"},
           {"keys", keys, "keys pressed at the start, separated by commas: m,3,Down"},
           {"follow", arguments.follow,
            "show the map after each frame; MAP is the output folder of a running or "
            "starting pcl_semantic_map --view; --images shows the newest image"}},
          {{"size", tool::withDefault(arguments.picture.texts.size),
            "size of the window or picture [px]"},
           {"threads", tool::withDefault(arguments.threads),
            "number of threads; 0 = all processors"}}),
      {"map"});
  tool::refuseIf(arguments.map.empty(), "MAP is missing");
  tool::refuseIf(arguments.follow && !arguments.screenshot.empty(),
                 "--follow needs a window, --screenshot has none");
  tool::requireOutput(arguments.screenshot, ".png");
  tool::refuseSameFiles({arguments.map, arguments.picture.objects,
                         arguments.picture.planes, arguments.picture.hints.trajectory,
                         arguments.picture.hints.label_set},
                        {arguments.screenshot});
  if (!arguments.colour.empty())
    tool::requireColour(arguments.colour);
  tool::refuseIf(std::isnan(arguments.state.below),
                 "--below is not a number, expected a height [m]");
  arguments.hide = tool::splitAtCommas(hide);
  arguments.keys = tool::splitAtCommas(keys);
  tool::readRenderOptions(values, arguments.picture);
  return arguments;
}

constexpr std::size_t kMaxImages = 12;

// A view of the whole map that the panel does not cover.
SceneView
besidePanel(const std::string& name, RenderOptions options, const VoxelScene& scene,
            const Trajectory& poses)
{
  const int panel = options.size.width > 3 * tool::kPanelWidth ? tool::kPanelWidth : 0;
  options.looks_from = false;
  options.view = name;
  options.size.width -= panel;
  SceneView view = tool::viewOf(options, scene, poses);
  view.camera.width += panel;
  view.camera.cx += panel;
  return view;
}

// The requested view, followed by the standard views.
std::vector<SceneView>
viewsOf(const RenderOptions& options, const VoxelScene& scene, const Trajectory& poses)
{
  std::vector<SceneView> views;
  if (options.looks_from || options.view == "camera")
    views.push_back(tool::viewOf(options, scene, poses));
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
  views.push_back(tool::viewOf(last, scene, poses));
  return views;
}

// The camera's current position, seen from behind.
SceneView
behindCamera(const tool::ViewedMap& map, const Arguments& arguments)
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
      badParameter("--hide: no class is called '", name, "'");
    labels.insert(label);
  }
  return labels;
}

// A map with its views and its visible parts.
struct OpenedMap {
  tool::ViewedMap map;
  std::vector<SceneView> views;
  tool::ViewState state;
};

OpenedMap
openMap(const Arguments& arguments)
{
  const tool::MapInput input = tool::readMap(arguments.map, arguments.picture.hints);
  tool::requireVoxels(arguments.map, input);
  OpenedMap opened;
  opened.views = viewsOf(arguments.picture, input.scene, tool::posesInScene(input));
  opened.map = tool::viewedMap(input.scene, input.label_set, arguments.map);
  opened.map.objects = tool::viewedObjects(
      tool::readMapObjects(arguments.map, arguments.picture.objects, input.label_set),
      input.label_set, input.scene.grid.size, input.scene.origin);
  if (!arguments.picture.planes.empty())
    opened.map.outlines =
        outlineLines(readPlanes(arguments.picture.planes, input.label_set),
                     input.label_set, input.scene.origin);
  opened.map.path = input.T_world_camera;
  for (Eigen::Isometry3d& pose : opened.map.path)
    pose.translation() -= input.scene.origin;
  opened.state = arguments.state;
  opened.state.hidden = labelsOf(arguments.hide, input.label_set);
  if (!arguments.colour.empty())
    opened.state.colouring = tool::colouringOf(opened.map, arguments.colour);
  if (!arguments.images.empty()) {
    if (opened.map.path.empty())
      badParameter("--images needs the poses of the camera; give --trajectory");
    opened.map.pictures = tool::imagesOf(arguments.images, opened.map.path,
                                         arguments.follow ? 1 : kMaxImages);
    opened.state.pictures = true;
  }
  const std::filesystem::path path(arguments.map);
  opened.map.title =
      (path.has_filename() ? path : path.parent_path()).filename().string();
  return opened;
}

// Shows the map of a folder while pcl_semantic_map --view writes to it: the
// surroundings of the sensor after each frame, and finally the whole map.
class FollowedMap {
public:
  FollowedMap(const Arguments& arguments, MapViewer& viewer)
      : arguments_(arguments), viewer_(viewer), folder_(arguments.map)
  {}

  // Shows the map if it has changed.
  void
  update()
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
        // The map is missing or currently being replaced.
      }
      return;
    }
  }

private:
  void
  show(OpenedMap opened)
  {
    if (!opened.map.path.empty()) {
      opened.views.insert(opened.views.begin(), behindCamera(opened.map, arguments_));
      const Eigen::Vector3d position = opened.map.path.back().translation();
      if (!is_first_) // the camera follows the sensor
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

  Arguments arguments_;
  MapViewer& viewer_;
  const std::string folder_;
  std::filesystem::file_time_type shown_; // time of the shown map
  bool is_first_ = true;
  Eigen::Vector3d last_position_ = Eigen::Vector3d::Zero(); // of the camera
};

int
leave(const Arguments& arguments, MapViewer& viewer)
{
  if (arguments.screenshot.empty())
    return tool::interrupted() ? tool::exit_interrupted : tool::exit_done;
  writePng(arguments.screenshot, viewer.picture());
  tool::printResults({{"picture", arguments.screenshot}});
  return tool::exit_done;
}

int
viewMap(const Arguments& arguments)
{
  OpenedMap opened = openMap(arguments);
  MapViewer viewer("pcl_semantic_view: " + arguments.map, arguments.picture.size,
                   !arguments.screenshot.empty());
  viewer.state() = opened.state;
  viewer.show(std::move(opened.map), std::move(opened.views));
  for (const std::string& key : arguments.keys)
    viewer.press(key);
  if (arguments.screenshot.empty())
    viewer.run([] {});
  return leave(arguments, viewer);
}

int
followMap(const Arguments& arguments)
{
  MapViewer viewer("pcl_semantic_view: " + arguments.map, arguments.picture.size,
                   false);
  FollowedMap map(arguments, viewer);
  std::cout << "following: " << arguments.map << std::endl;
  std::signal(SIGPIPE,
              SIG_IGN); // the program that started the window may end earlier
  viewer.run([&] { map.update(); });
  return leave(arguments, viewer);
}

int
view(const Arguments& arguments, char** argv)
{
  setNumberOfThreads(arguments.threads);
  if (!tool::hasDisplay()) {
    if (arguments.screenshot.empty())
      badParameter("there is no display with OpenGL to open a window on (DISPLAY); "
                   "pcl_semantic_view MAP --screenshot OUT.png needs none");
    tool::restartOnVirtualDisplay(argv);
  }
  tool::catchInterrupts();
  return arguments.follow ? followMap(arguments) : viewMap(arguments);
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run("pcl_semantic_view", [&] { return view(parse(argc, argv), argv); });
}
