/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "render_arguments.h"

#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/input_file.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic::tool {

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
sizeOf(const std::string& text)
{
  const std::vector<double> sides = numbersOf(text, 'x', 2, "--size");
  for (const double side : sides)
    if (!(side >= 160.0 && side <= 8192.0 && side == std::floor(side)))
      fail("--size is " + text + ", expected WIDTHxHEIGHT from 160 to 8192");
  return {int(sides[0]), int(sides[1])};
}

Eigen::Vector3d
placeOf(const std::string& text, const char* option)
{
  const std::vector<double> place = numbersOf(text, ',', 3, option);
  return {place[0], place[1], place[2]};
}

void
validate(const RenderArguments& arguments)
{
  if (arguments.map.empty() || arguments.output.empty())
    fail("MAP or OUT.png is missing");
  requireExtension(arguments.output, ".png");
  refuseSameFiles({arguments.map, arguments.compare, arguments.hints.trajectory},
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
  if (!(arguments.hints.voxel_size >= 0.0))
    fail("--voxel-size is less than 0");
}

/** \brief Options as they are typed. */
struct Texts {
  std::string from, look_at, size = "1600x900";
  double degrees = 60.0;
};

po::options_description
optionsOf(RenderArguments& arguments, Texts& texts)
{
  po::options_description options("Options");
  options.add_options()("map", po::value(&arguments.map), "the map")(
      "output", po::value(&arguments.output), "the picture to write")(
      "compare", po::value(&arguments.compare),
      "another map, from before: shows where the classes changed since")(
      "trajectory", po::value(&arguments.hints.trajectory),
      "path to draw, KITTI or TUM; default: trajectory.txt of the folder")(
      "from", po::value(&texts.from), "look from X,Y,Z, as the cloud's points [m]")(
      "look-at", po::value(&texts.look_at), "look towards X,Y,Z [m]")(
      "label-set", po::value(&arguments.hints.label_set),
      "classes (YAML); default: an archive's own, or the eleven of KITTI")(
      "voxel-size", po::value(&arguments.hints.voxel_size),
      "edge of the cubes [m]; default: what the map says, or its points")(
      "small", po::bool_switch(&arguments.small),
      "half the bytes, in fewer shades of colour");
  addOption(options, "view", arguments.view,
            "angle (along the path from above), above, camera");
  addOption(options, "colour", arguments.colour,
            "class, rgb, entropy, clique, change (needs --compare)");
  addOption(options, "frame", arguments.frame,
            "row of the trajectory that --view camera looks from");
  addOption(options, "field-of-view", texts.degrees,
            "over the width, of --from and --view camera [degrees]");
  addOption(options, "size", texts.size, "of the picture without its legend");
  addOption(options, "threads", arguments.threads, "0 = all processors");
  return options;
}

} // namespace

bool
parseRenderArguments(int argc, char** argv, RenderArguments& arguments)
{
  Texts texts;
  const po::options_description options = optionsOf(arguments, texts);
  po::positional_options_description positional;
  positional.add("map", 1).add("output", 1);
  po::variables_map values;
  if (!parseCommandLine(argc, argv, usage, options, positional, values))
    return false;
  if (!arguments.compare.empty() && values["colour"].defaulted())
    arguments.colour = "change";
  arguments.size = sizeOf(texts.size);
  arguments.field_of_view = texts.degrees * M_PI / 180.0;
  if (texts.from.empty() != texts.look_at.empty())
    fail("--from and --look-at belong together");
  arguments.looks_from = !texts.from.empty();
  if (arguments.looks_from) {
    arguments.from = placeOf(texts.from, "--from");
    arguments.look_at = placeOf(texts.look_at, "--look-at");
  }
  validate(arguments);
  return true;
}

} // namespace pcl_semantic::tool
