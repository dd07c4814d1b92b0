// SPDX-License-Identifier: BSD-3-Clause
#include "messages.h"
#include "render_options.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/io/scene_image.h>

#include <string>

namespace pcl_semantic::tool {

/** \brief What pcl_semantic_render is asked for. */
struct RenderArguments {
  std::string map, output;
  std::string compare; ///< another map; empty = none
  std::string colour = "class";
  int threads = 0;
  bool small = false;
  RenderOptions picture;
};

/** \return false if help or version was asked for
 * \throws InvalidParameterException */
bool parseRenderArguments(int argc, char** argv, RenderArguments& arguments);

namespace {

const Usage usage{
    "pcl_semantic_render", "MAP OUT.png [options]",
    "Draws a labelled map as solid cubes, without a window or a graphics card. MAP is "
    "a\n"
    "folder that pcl_semantic_map has written (its path and voxel size are known "
    "then), a\n"
    "labelled .pcd, or a map archive.",
    "pcl_semantic_synthesize /tmp/street && \\\n"
    "  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output /tmp/map && "
    "\\\n"
    "  pcl_semantic_render /tmp/map /tmp/map.png"};

[[noreturn]] void
fail(const std::string& message)
{
  failUsage(usage, message);
}

void
validate(const RenderArguments& arguments)
{
  if (arguments.map.empty() || arguments.output.empty())
    fail("MAP or OUT.png is missing");
  requireOutput(arguments.output, ".png");
  refuseSameFiles(
      {arguments.map, arguments.compare, arguments.picture.hints.trajectory},
      {arguments.output});
  requireOneOf(usage, "--colour", arguments.colour,
               {"class", "rgb", "entropy", "observations", "clique", "change"},
               "class, rgb, entropy, observations, clique or change");
  if ((arguments.colour == "change") == arguments.compare.empty())
    fail("--colour change and --compare belong together");
}

po::options_description
optionsOf(RenderArguments& arguments)
{
  po::options_description options("Options");
  options.add_options()("map", po::value(&arguments.map), "the map")(
      "output", po::value(&arguments.output),
      "output image (.png)")("compare", po::value(&arguments.compare),
                             "earlier map; shows where classes changed since")(
      "small", po::bool_switch(&arguments.small), "palette image of half the size");
  addRenderOptions(arguments.picture, options);
  addOption(options, "size", arguments.picture.texts.size,
            "size of the image without its legend [px]");
  addOption(options, "colour", arguments.colour,
            "class, rgb, entropy, observations, clique, change (needs --compare)");
  addOption(options, "threads", arguments.threads,
            "number of threads; 0 = all processors");
  return options;
}

} // namespace

bool
parseRenderArguments(int argc, char** argv, RenderArguments& arguments)
{
  const po::options_description options = optionsOf(arguments);
  po::positional_options_description positional;
  positional.add("map", 1).add("output", 1);
  po::variables_map values;
  if (!parseCommandLine(argc, argv, usage, options, positional, values))
    return false;
  if (!arguments.compare.empty() && values["colour"].defaulted())
    arguments.colour = "change";
  readRenderOptions(usage, arguments.picture);
  validate(arguments);
  return true;
}

} // namespace pcl_semantic::tool

namespace {

using namespace pcl_semantic;
using tool::RenderArguments;

VoxelColours
coloursOf(const RenderArguments& arguments, const tool::MapInput& map)
{
  if (arguments.colour == "rgb")
    return measuredColours(map.scene);
  if (arguments.colour == "entropy")
    return entropyColours(map.scene);
  if (arguments.colour == "observations")
    return observationColours(map.scene);
  if (arguments.colour == "clique")
    return cliqueColours(map.scene);
  if (!map.scene.has_labels)
    PCL_THROW_EXCEPTION(BadInputException,
                        arguments.map << ": has no labels, expected a field label or "
                                         "probability");
  if (arguments.compare.empty())
    return classColours(map.scene, map.label_set);
  const VoxelScene other =
      tool::readOtherMap(arguments.compare, arguments.picture.hints, map.scene);
  return changeColours(map.scene, labelsAtVoxels(map.scene, other), map.label_set);
}

int
render(const RenderArguments& arguments)
{
  setNumberOfThreads(arguments.threads);
  const tool::MapInput map = tool::readMap(arguments.map, arguments.picture.hints);
  const Trajectory poses = tool::posesInScene(map);
  const VoxelColours colours = coloursOf(arguments, map);
  const SceneView view = tool::viewOf(arguments.picture, map.scene, poses);
  // The path would lead out of the camera's own eye.
  const cv::Mat picture = drawVoxels(
      map.scene, colours, view,
      arguments.picture.view == "camera" ? SensorPath() : tool::pathOf(poses));
  (arguments.small ? writeSmallPng : writePng)(arguments.output, picture);
  tool::printResults({{"picture", arguments.output}});
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run("pcl_semantic_render", [&] {
    RenderArguments arguments;
    return tool::parseRenderArguments(argc, argv, arguments) ? render(arguments)
                                                             : int(tool::exit_done);
  });
}
