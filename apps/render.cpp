/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "map_input.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/small_png.h>
#include <pcl_semantic/io/voxel_picture.h>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace {

using namespace pcl_semantic;
namespace po = tool::po;

const tool::Usage usage{
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

struct Arguments {
  std::string map, output, compare, from, look_at;
  std::string view = "angle", colour = "class", size = "1600x900";
  bool small = false;
  tool::MapHints hints;
  int frame = 0, threads = 0;
  double field_of_view = 60.0; // [degrees]
};

[[noreturn]] void
fail(const std::string& message)
{
  tool::failUsage(usage, message);
}

void
validate(const Arguments& arguments)
{
  if (arguments.map.empty() || arguments.output.empty())
    fail("MAP or OUT.png is missing");
  tool::requireExtension(arguments.output, ".png");
  tool::refuseSameFiles({arguments.map, arguments.compare, arguments.hints.trajectory},
                        {arguments.output});
  const auto requireOneOf = [](const char* option, const std::string& value,
                               const std::vector<std::string>& known,
                               const char* expected) {
    if (std::count(known.begin(), known.end(), value) == 0)
      fail(std::string(option) + " is '" + value + "', expected " + expected);
  };
  requireOneOf("--view", arguments.view, {"angle", "above", "camera"},
               "angle, above or camera");
  requireOneOf("--colour", arguments.colour,
               {"class", "rgb", "entropy", "clique", "change"},
               "class, rgb, entropy, clique or change");
  if ((arguments.colour == "change") == arguments.compare.empty())
    fail("--colour change and --compare belong together");
  if (arguments.from.empty() != arguments.look_at.empty())
    fail("--from and --look-at belong together");
  if (!(arguments.hints.voxel_size >= 0.0))
    fail("--voxel-size is less than 0");
}

bool
parse(int argc, char** argv, Arguments& arguments)
{
  po::options_description options("Options");
  options.add_options()("map", po::value(&arguments.map), "the map")(
      "output", po::value(&arguments.output), "the picture to write")(
      "compare", po::value(&arguments.compare),
      "another map, from before: shows where the classes changed since")(
      "trajectory", po::value(&arguments.hints.trajectory),
      "path to draw, KITTI or TUM; default: trajectory.txt of the folder")(
      "from", po::value(&arguments.from), "look from X,Y,Z, as the cloud's points [m]")(
      "look-at", po::value(&arguments.look_at), "look towards X,Y,Z [m]")(
      "label-set", po::value(&arguments.hints.label_set),
      "classes (YAML); default: an archive's own, or the eleven of KITTI")(
      "voxel-size", po::value(&arguments.hints.voxel_size),
      "edge of the cubes [m]; default: what the map says, or its points")(
      "small", po::bool_switch(&arguments.small),
      "half the bytes, in fewer shades of colour");
  tool::addOption(options, "view", arguments.view,
                  "angle (along the path from above), above, camera");
  tool::addOption(options, "colour", arguments.colour,
                  "class, rgb, entropy, clique, change (needs --compare)");
  tool::addOption(options, "frame", arguments.frame,
                  "row of the trajectory that --view camera looks from");
  tool::addOption(options, "field-of-view", arguments.field_of_view,
                  "over the width, of --from and --view camera [degrees]");
  tool::addOption(options, "size", arguments.size, "of the picture without its legend");
  tool::addOption(options, "threads", arguments.threads, "0 = all processors");
  po::positional_options_description positional;
  positional.add("map", 1).add("output", 1);
  po::variables_map values;
  if (!tool::parseCommandLine(argc, argv, usage, options, positional, values))
    return false;
  if (!arguments.compare.empty() && values["colour"].defaulted())
    arguments.colour = "change";
  validate(arguments);
  return true;
}

std::vector<double>
numbersOf(std::string text, char separator, std::size_t count, const char* option)
{
  std::replace(text.begin(), text.end(), separator, ' ');
  std::vector<double> numbers;
  try {
    numbers = parseNumbers(text, option);
  }
  catch (const BadInputException& error) {
    fail(error.what());
  }
  if (numbers.size() != count)
    fail(std::string(option) + " has " + std::to_string(numbers.size()) +
         " numbers, expected " + std::to_string(count));
  return numbers;
}

cv::Size
sizeOf(const Arguments& arguments)
{
  const std::vector<double> sides = numbersOf(arguments.size, 'x', 2, "--size");
  for (const double side : sides)
    if (!(side >= 160.0 && side <= 8192.0 && side == std::floor(side)))
      fail("--size is " + arguments.size + ", expected WIDTHxHEIGHT from 160 to 8192");
  return {int(sides[0]), int(sides[1])};
}

Eigen::Vector3d
placeOf(const std::string& text, const char* option, const tool::MapInput& map)
{
  const std::vector<double> place = numbersOf(text, ',', 3, option);
  return Eigen::Vector3d(place[0], place[1], place[2]) - map.scene.grid.corner;
}

PictureView
viewOf(const Arguments& arguments, const tool::MapInput& map, const Trajectory& poses,
       const SensorPath& path)
{
  const cv::Size size = sizeOf(arguments);
  const double field_of_view = arguments.field_of_view * M_PI / 180.0;
  if (!arguments.from.empty())
    return lookAt(placeOf(arguments.from, "--from", map),
                  placeOf(arguments.look_at, "--look-at", map), field_of_view, size);
  if (arguments.view == "camera") {
    if (arguments.frame < 0 || std::size_t(arguments.frame) >= poses.size())
      fail("--view camera: the trajectory has " + std::to_string(poses.size()) +
           " poses, none for --frame " + std::to_string(arguments.frame));
    const Eigen::Isometry3d& pose = poses[std::size_t(arguments.frame)];
    return lookAt(pose.translation(), pose * Eigen::Vector3d::UnitZ(), field_of_view,
                  size);
  }
  return arguments.view == "above" ? aboveView(map.scene, path, size)
                                   : angleView(map.scene, path, size);
}

VoxelColours
coloursOf(const Arguments& arguments, const tool::MapInput& map)
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
render(const Arguments& arguments)
{
  setNumberOfThreads(arguments.threads);
  sizeOf(arguments); // before the map is read
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
  std::cout << "picture: " << arguments.output << "\n";
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run(usage.name, [&] {
    Arguments arguments;
    return parse(argc, argv, arguments) ? render(arguments) : int(tool::exit_done);
  });
}
