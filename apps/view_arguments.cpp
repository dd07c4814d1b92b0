// SPDX-License-Identifier: BSD-3-Clause
#include "view_arguments.h"

#include "view_state.h"

#include <sstream>

namespace pcl_semantic::tool {

namespace {

Usage
usageOfView()
{
  std::string keys;
  for (const std::string& line : helpOnKeys())
    keys += "\n  " + line;
  return {
      "pcl_semantic_view", "MAP [options]",
      "Shows a labelled map in a window. MAP is a folder that pcl_semantic_map has\n"
      "written, a .pcd, or a map archive. --screenshot writes what the window would\n"
      "show and ends; it needs no display. Keys:" +
          keys,
      "pcl_semantic_synthesize /tmp/street && \\\n"
      "  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output "
      "/tmp/map && \\\n"
      "  pcl_semantic_view /tmp/map --hide vegetation --screenshot /tmp/view.png"};
}

std::vector<std::string>
wordsOf(const std::string& text)
{
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');)
    words.push_back(word);
  return words;
}

po::options_description
optionsOf(ViewArguments& arguments, std::string& hide, std::string& keys)
{
  po::options_description options("Options");
  options.add_options()("map", po::value(&arguments.map), "the map")(
      "screenshot", po::value(&arguments.screenshot),
      "write a picture (.png) instead of opening a window")(
      "colour", po::value(&arguments.colour),
      "class, rgb, entropy, observations, clique; default: the first that MAP has")(
      "hide", po::value(&hide), "classes to hide, by name, with commas between them")(
      "below", po::value(&arguments.below), "show only what is below this height [m]")(
      "above", po::value(&arguments.above), "show only what is above this height [m]")(
      "images", po::value(&arguments.images),
      "show pictures of this sequence (KITTI's layout) where the camera was")(
      "keys", po::value(&keys),
      "keys pressed at the beginning, with commas between them: m,3,Down")(
      "follow", po::bool_switch(&arguments.follow),
      "MAP is the output folder of a pcl_semantic_map --view that runs or is about to: "
      "show the map after each frame; --images shows the newest image");
  options.add_options()("small", po::bool_switch(&arguments.small),
                        "half the bytes, in fewer shades of colour");
  addRenderOptions(arguments.picture, options);
  addOption(options, "size", arguments.picture.texts.size, "of the window or picture");
  addOption(options, "threads", arguments.threads, "0 = all processors");
  return options;
}

} // namespace

bool
parseViewArguments(int argc, char** argv, ViewArguments& arguments)
{
  std::string hide, keys;
  const Usage usage = usageOfView();
  const po::options_description options = optionsOf(arguments, hide, keys);
  po::positional_options_description positional;
  positional.add("map", 1);
  po::variables_map values;
  if (!parseCommandLine(argc, argv, usage, options, positional, values))
    return false;
  if (arguments.map.empty())
    failUsage(usage, "MAP is missing");
  if (arguments.follow && !arguments.screenshot.empty())
    failUsage(usage, "--follow needs a window, --screenshot has none");
  requireOutput(arguments.screenshot, ".png");
  refuseSameFiles({arguments.map, arguments.picture.hints.trajectory,
                   arguments.picture.hints.label_set},
                  {arguments.screenshot});
  if (!arguments.colour.empty())
    requireOneOf(usage, "--colour", arguments.colour,
                 {"class", "rgb", "entropy", "observations", "clique"},
                 "class, rgb, entropy, observations or clique");
  if (!(arguments.above < arguments.below))
    failUsage(usage, "--above is not less than --below: nothing would be shown");
  arguments.hide = wordsOf(hide);
  arguments.keys = wordsOf(keys);
  readRenderOptions(usage, arguments.picture);
  return true;
}

} // namespace pcl_semantic::tool
