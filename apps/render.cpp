// SPDX-License-Identifier: BSD-3-Clause
#include "messages.h"
#include "render_options.h"
#include "tool.h"

#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/plane_file.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/pictures/scene_image.h>

#include <string>

namespace {

using namespace pcl_semantic;

struct Arguments {
  std::string map, output;
  std::string compare; ///< another map; empty = none
  std::string colour = "class";
  int threads = 0;
  tool::RenderOptions picture;
};

const tool::Usage usage{
    "pcl_semantic_render", "MAP OUT.png [options]",
    "Draws a labelled map as solid cubes, without a window or a graphics card. MAP is "
    "a\nfolder that pcl_semantic_map has written (with its trajectory and voxel size), "
    "a labelled\n.pcd or .ply, or a map archive.",
    "pcl_semantic_synthesize /tmp/street && \\\n"
    "  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output /tmp/map && "
    "\\\n"
    "  pcl_semantic_render /tmp/map /tmp/map.png"};

void
validate(const Arguments& arguments)
{
  tool::refuseIf(arguments.map.empty() || arguments.output.empty(),
                 "MAP or OUT.png is missing");
  tool::requireOutput(arguments.output, ".png");
  tool::refuseSameFiles({arguments.map, arguments.compare,
                         arguments.picture.hints.trajectory, arguments.picture.objects,
                         arguments.picture.planes},
                        {arguments.output});
  tool::requireColour(arguments.colour);
}

Arguments
parse(int argc, char** argv)
{
  tool::refuseRemoved(argc, argv, tool::removed_render_options);
  Arguments arguments;
  const auto values = tool::parseCommandLine(
      argc, argv, usage,
      tool::withRenderOptions(
          arguments.picture,
          {{"map", arguments.map, "input map"},
           {"output", arguments.output, "output image (.png)"},
           {"compare", arguments.compare,
            "earlier map; the picture shows the voxels whose class changed"}},
          {{"size", tool::withDefault(arguments.picture.texts.size),
            "size of the image without its legend [px]"},
           {"colour", tool::withDefault(arguments.colour),
            "colour of voxels: class, rgb, or entropy of the labels"},
           {"threads", tool::withDefault(arguments.threads),
            "number of threads; 0 = all processors"}}),
      {"map", "output"});
  tool::refuseIf(!arguments.compare.empty() && !values["colour"].defaulted(),
                 "--colour has no effect with --compare, which has its own colours");
  tool::readRenderOptions(values, arguments.picture);
  validate(arguments);
  return arguments;
}

VoxelColours
coloursOf(const Arguments& arguments, const tool::MapInput& map)
{
  if (arguments.colour == "rgb")
    return measuredColours(map.scene);
  if (arguments.colour == "entropy")
    return entropyColours(map.scene);
  if (!map.scene.has_labels)
    badInput(arguments.map, ": has no labels, expected a field label or probability");
  if (arguments.compare.empty())
    return classColours(map.scene, map.label_set);
  const VoxelScene other =
      tool::readOtherMap(arguments.compare, arguments.picture.hints, map.scene);
  return changeColours(map.scene, labelsAtVoxels(map.scene, other), map.label_set);
}

// The edges of the objects' boxes, in a picture of changes only those asked for, and
// the outlines of planes.
std::vector<SceneLine>
linesOf(const Arguments& arguments, const tool::MapInput& map)
{
  const Eigen::Vector3d origin = map.scene.origin + map.scene.grid.corner;
  const std::string& objects = arguments.picture.objects;
  std::vector<SceneLine> lines;
  if (!objects.empty() || arguments.compare.empty())
    lines = boxLines(tool::readMapObjects(arguments.map, objects, map.label_set),
                     map.label_set, origin);
  if (const std::string& planes = arguments.picture.planes; !planes.empty()) {
    const std::vector<SceneLine> outlines =
        outlineLines(readPlanes(planes, map.label_set), map.label_set, origin);
    lines.insert(lines.end(), outlines.begin(), outlines.end());
  }
  return lines;
}

int
render(const Arguments& arguments)
{
  setNumberOfThreads(arguments.threads);
  const tool::MapInput map = tool::readMap(arguments.map, arguments.picture.hints);
  tool::requireVoxels(arguments.map, map);
  const Trajectory poses = tool::posesInScene(map);
  const VoxelColours colours = coloursOf(arguments, map);
  const SceneView view = tool::viewOf(arguments.picture, map.scene, poses);
  // From the camera, the path would cover the view.
  const cv::Mat picture = drawVoxels(
      map.scene, colours, view,
      arguments.picture.view == "camera" ? SensorPath() : tool::pathOf(poses),
      linesOf(arguments, map));
  writePng(arguments.output, picture);
  tool::printResults({{"picture", arguments.output}});
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run("pcl_semantic_render", [&] { return render(parse(argc, argv)); });
}
