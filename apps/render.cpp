// SPDX-License-Identifier: BSD-3-Clause
#include "messages.h"
#include "render_arguments.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/io/voxel_picture.h>

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
  const PictureView view = tool::viewOf(arguments.picture, map.scene, poses);
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
