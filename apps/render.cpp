/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "messages.h"
#include "render_arguments.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/files/small_png.h>
#include <pcl_semantic/io/voxel_picture.h>

namespace {

using namespace pcl_semantic;
using tool::RenderArguments;

PictureView
viewOf(const RenderArguments& arguments, const tool::MapInput& map,
       const Trajectory& poses, const SensorPath& path)
{
  const Eigen::Vector3d& corner = map.scene.grid.corner;
  if (arguments.looks_from)
    return lookAt(arguments.from - corner, arguments.look_at - corner,
                  arguments.field_of_view, arguments.size);
  if (arguments.view == "camera") {
    if (arguments.frame < 0 || std::size_t(arguments.frame) >= poses.size())
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "--view camera: the trajectory has "
                              << poses.size() << " poses, none for --frame "
                              << arguments.frame);
    const Eigen::Isometry3d& pose = poses[std::size_t(arguments.frame)];
    return lookAt(pose.translation(), pose * Eigen::Vector3d::UnitZ(),
                  arguments.field_of_view, arguments.size);
  }
  return arguments.view == "above" ? aboveView(map.scene, path, arguments.size)
                                   : angleView(map.scene, path, arguments.size);
}

VoxelColours
coloursOf(const RenderArguments& arguments, const tool::MapInput& map)
{
  if (arguments.colour == "rgb")
    return measuredColours(map.scene);
  if (arguments.colour == "entropy")
    return entropyColours(map.scene);
  if (arguments.colour == "clique")
    return cliqueColours(map.scene);
  if (!map.scene.has_labels)
    PCL_THROW_EXCEPTION(BadInputException,
                        arguments.map << ": has no labels, expected a field label or "
                                         "probability");
  if (arguments.compare.empty())
    return classColours(map.scene, map.label_set);
  const VoxelScene other =
      tool::readOtherMap(arguments.compare, arguments.hints, map.scene);
  return changeColours(map.scene, labelsAtVoxels(map.scene, other), map.label_set);
}

int
render(const RenderArguments& arguments)
{
  setNumberOfThreads(arguments.threads);
  const tool::MapInput map = tool::readMap(arguments.map, arguments.hints);
  const Trajectory poses = tool::posesInScene(map);
  SensorPath path;
  for (const Eigen::Isometry3d& pose : poses)
    path.push_back(pose.translation());
  const VoxelColours colours = coloursOf(arguments, map);
  const PictureView view = viewOf(arguments, map, poses, path);
  // The path would lead out of the camera's own eye.
  const cv::Mat picture = drawVoxels(map.scene, colours, view,
                                     arguments.view == "camera" ? SensorPath() : path);
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
