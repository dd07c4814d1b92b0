// SPDX-License-Identifier: BSD-3-Clause
#include "render_arguments.h"

#include "tool.h"

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

void
validate(const RenderArguments& arguments)
{
  if (arguments.map.empty() || arguments.output.empty())
    fail("MAP or OUT.png is missing");
  requireExtension(arguments.output, ".png");
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
      "output", po::value(&arguments.output), "the picture to write")(
      "compare", po::value(&arguments.compare),
      "another map, from before: shows where the classes changed since")(
      "small", po::bool_switch(&arguments.small),
      "half the bytes, in fewer shades of colour");
  addPictureOptions(arguments.picture, options);
  addOption(options, "size", arguments.picture.texts.size,
            "of the picture without its legend");
  addOption(options, "colour", arguments.colour,
            "class, rgb, entropy, observations, clique, change (needs --compare)");
  addOption(options, "threads", arguments.threads, "0 = all processors");
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
  readPictureOptions(usage, arguments.picture);
  validate(arguments);
  return true;
}

} // namespace pcl_semantic::tool
