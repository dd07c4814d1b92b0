// SPDX-License-Identifier: BSD-3-Clause
#include "core/text_stream.h"
#include "image_tool.h"
#include "map_input.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/io/octree_file.h>
#include <pcl_semantic/pictures/occupancy_grid.h>
#include <pcl_semantic/pictures/ply_file.h>
#include <pcl_semantic/pictures/voxel_colours.h>

#include <filesystem>
#include <string>
#include <vector>

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

const Usage usage{
    "pcl_semantic_export", "MAP OUT [options]",
    R"(Writes a labelled map for other programs. MAP is a folder that pcl_semantic_map has
written, a labelled .pcd or .ply, or a map archive. The extension of OUT selects the format:
  .bt    octree of OctoMap, occupied and free
  .ply   points with labels
  .pgm   occupancy grid with its .yaml, as map_server of ROS reads it
Only an archive stores free space. From a folder or a cloud, an octree leaves all other
space unknown, and a grid marks ground without an obstacle as free.
pcl_semantic_archive export writes parts of an archive.)",
    R"(pcl_semantic_synthesize /tmp/street && \
  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output /tmp/map \
    --archive /tmp/street_map && \
  pcl_semantic_export /tmp/street_map /tmp/street.bt && \
  pcl_semantic_export /tmp/map /tmp/street.ply && \
  pcl_semantic_export /tmp/map /tmp/street.pgm --ground road)"};

enum class Format { octree, points, grid };

struct Arguments {
  std::string map, output;
  Format format = Format::points;
  MapHints hints;
  std::string colour = "class"; ///< or rgb, the measured colour
  std::string ground;           ///< class names; empty = usual ones, if they exist
  double min_height = 0.3, max_height = 2.0, reach = 5.0; ///< [m]
};

Format
formatOf(const std::string& output)
{
  const std::string extension = std::filesystem::path(output).extension().string();
  if (extension != ".bt" && extension != ".ply" && extension != ".pgm")
    failUsage(output + ": expected a name that ends in .bt, .ply or .pgm");
  requireOutput(output, extension);
  return extension == ".bt"    ? Format::octree
         : extension == ".ply" ? Format::points
                               : Format::grid;
}

void
validate(const Arguments& arguments)
{
  std::vector<std::string> outputs = {arguments.output};
  if (arguments.format == Format::grid)
    outputs.push_back(gridDescription(arguments.output));
  refuseSameFiles({arguments.map, arguments.hints.label_set}, outputs);
  refuseIf(arguments.colour != "class" && arguments.colour != "rgb",
           "--colour is '" + arguments.colour + "', expected class or rgb");
  refuseIf(!(arguments.hints.voxel_size >= 0.0), "--voxel-size is less than 0");
  refuseIf(
      !(arguments.min_height >= 0.0 && arguments.max_height > arguments.min_height),
      "expected 0 <= --min-height < --max-height");
  refuseIf(!(arguments.reach >= 0.0), "--ground-reach is less than 0");
}

Arguments
parse(int argc, char** argv)
{
  refuseRemoved(argc, argv,
                {{"format", "the name of OUT says what is written"},
                 {"traversable", "--ground names the classes that count as ground"}});
  Arguments arguments;
  const po::variables_map values = parseCommandLine(
      argc, argv, usage,
      {{"map", arguments.map, "input map"},
       {"output", arguments.output, "output file"},
       {"label-set", arguments.hints.label_set,
        "label set (YAML; default: that of the archive, or label_sets/kitti11.yaml)"},
       {"voxel-size", arguments.hints.voxel_size,
        "voxel size [m] (default: that of the map, or of its points)"},
       {"ground", arguments.ground,
        "ground classes, separated by commas (default: road, sidewalk, terrain, "
        "parking and other ground, if in the label set)"},
       {"colour", withDefault(arguments.colour), "colour of points: class or rgb"},
       {"min-height", withDefault(arguments.min_height),
        "minimum height of an obstacle above the ground [m]"},
       {"max-height", withDefault(arguments.max_height),
        "maximum height of an obstacle above the ground [m]"},
       {"ground-reach", withDefault(arguments.reach),
        "distance over which the height of the ground is extrapolated [m]"}},
      {"map", "output"});
  refuseIf(arguments.map.empty() || arguments.output.empty(), "MAP or OUT is missing");
  arguments.format = formatOf(arguments.output);
  refuseUnread(
      values,
      {{arguments.format != Format::grid,
        "without a .pgm to write",
        {"ground", "min-height", "max-height", "ground-reach"}},
       {arguments.format != Format::points, "without a .ply to write", {"colour"}},
       {arguments.format == Format::octree, "on a .bt", {"label-set"}}});
  validate(arguments);
  arguments.hints.free_space = arguments.format != Format::points;
  return arguments;
}

void
requireLabels(const MapInput& map)
{
  if (!map.scene.has_labels && map.scene.voxels.size() > 0)
    fail<BadInputException>("has no labels, expected a field label or probability");
}

// Unmodified class colours; rendered images have lighter ones.
std::vector<cv::Vec3b>
coloursOf(const Arguments& arguments, const MapInput& map)
{
  if (arguments.colour == "rgb")
    return measuredColours(map.scene).colours;
  requireLabels(map);
  std::vector<cv::Vec3b> colours;
  colours.reserve(map.scene.voxels.size());
  for (const pcl::PointXYZRGBL& point : *map.scene.voxels.cloud)
    colours.push_back(classColour(map.label_set, static_cast<Label>(point.label)));
  return colours;
}

// Classes of the ground: the given names, or the existing usual ones.
std::vector<Label>
groundOf(const std::string& list, const LabelSet& label_set)
{
  const std::vector<std::string> names = splitAtCommas(list);
  std::vector<Label> labels;
  for (const std::string& name :
       names.empty() ? std::vector<std::string>{"road", "sidewalk", "terrain",
                                                "parking", "other ground"}
                     : names) {
    const Label label = label_set.find(name);
    if (label != kUnlabelled)
      labels.push_back(label);
    else if (!names.empty())
      fail<InvalidParameterException>("--ground: the label set has no class '", name,
                                      "'");
  }
  if (labels.empty())
    fail<InvalidParameterException>("the label set has none of the default ground "
                                    "classes; name its ground classes with --ground");
  return labels;
}

Results
writeGrid(const Arguments& arguments, const MapInput& map)
{
  requireLabels(map);
  OccupancyGridParameters parameters;
  parameters.min_height = arguments.min_height;
  parameters.max_height = arguments.max_height;
  parameters.reach = arguments.reach;
  parameters.ground = groundOf(arguments.ground, map.label_set);
  const OccupancyGrid grid = occupancyGrid(map.scene, parameters);
  writeOccupancyGrid(arguments.output, grid);
  return {{"columns", std::size_t(grid.cells.cols)},
          {"rows", std::size_t(grid.cells.rows)},
          {"description", gridDescription(arguments.output)}};
}

Results
writeTree(const Arguments& arguments, const MapInput& map)
{
  const VoxelScene& scene = map.scene;
  writeOctree(arguments.output, scene);
  const Eigen::Vector3d shift = octreeShift(scene);
  if (shift.cwiseAbs().maxCoeff() > 1e-3 * scene.grid.size) {
    TextStream text;
    text << "the map is moved by " << shift.transpose()
         << " m: voxels of an octree begin at multiples of their size";
    warn(text.str());
  }
  if (scene.knows_free)
    return {{"free_voxels", scene.free.size()}};
  return {{"free_space", std::string("not known, the map is no archive")}};
}

Results
write(const Arguments& arguments, const MapInput& map)
{
  if (arguments.format == Format::octree)
    return writeTree(arguments, map);
  if (arguments.format == Format::grid)
    return writeGrid(arguments, map);
  writePlyPoints(arguments.output, map.scene, coloursOf(arguments, map));
  return {};
}

// A map without voxels is a valid file, but an image needs at least one pixel.
void
requireSize(const Arguments& arguments, const VoxelScene& scene)
{
  if (scene.voxels.size() > 0)
    return;
  if (arguments.format == Format::grid)
    fail<BadInputException>(arguments.map,
                            ": has no point, expected one or more for a .pgm");
  if (arguments.format == Format::octree && !(scene.grid.size > 0.0))
    fail<BadInputException>(
        arguments.map,
        ": has no point to derive the voxel size from; give --voxel-size");
  warn(arguments.map + ": no point is left");
}

int
exportMap(const Arguments& arguments)
{
  const MapInput map = readMap(arguments.map, arguments.hints);
  note(std::to_string(map.scene.voxels.size()) + " voxels are read");
  requireSize(arguments, map.scene);
  Results results = {{"file", arguments.output}, {"voxels", map.scene.voxels.size()}};
  try {
    for (const auto& result : write(arguments, map))
      results.push_back(result);
  }
  catch (const BadInputException& error) {
    fail<BadInputException>(arguments.map, ": ", error.what());
  }
  printResults(results);
  return exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return runWithImages(usage.name, [&] { return exportMap(parse(argc, argv)); });
}
