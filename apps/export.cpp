// SPDX-License-Identifier: BSD-3-Clause
#include "map_input.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/io/class_statistics.h>
#include <pcl_semantic/io/occupancy_grid.h>
#include <pcl_semantic/io/octree_file.h>
#include <pcl_semantic/io/ply_file.h>
#include <pcl_semantic/io/voxel_colours.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief What pcl_semantic_export can write. */
enum class ExportFormat {
  octree,
  colour_octree,
  points,
  mesh,
  occupancy,
  traversability,
  statistics
};

/** \brief Arguments of pcl_semantic_export. */
struct ExportArguments {
  std::string map, output;
  ExportFormat format = ExportFormat::points;
  MapHints hints;
  bool measured_colours = false; ///< else those of the classes
  /// Names of classes; empty = usual ones, as far as the label set has them.
  std::vector<std::string> ground, traversable;
  double min_height = 0.3, max_height = 2.0, reach = 5.0; ///< [m]
};

/** \return false if only the help or the version was wanted
 * \throws InvalidParameterException */
bool parseExportArguments(int argc, char** argv, ExportArguments& arguments);

namespace {

const Usage usage{
    "pcl_semantic_export", "MAP OUT [options]",
    "Writes a labelled map for other programs. MAP is a folder that pcl_semantic_map "
    "has\n"
    "written, a labelled .pcd, or a map archive. OUT says by its name what is "
    "written:\n"
    "  .bt    octree of OctoMap, occupied and free\n"
    "  .ot    the same in colours (ColorOcTree)\n"
    "  .ply   points; with --format mesh the faces of the voxels; both with labels\n"
    "  .pgm   occupancy grid with its .yaml, as map_server of ROS reads it; with\n"
    "         --format traversability where one can go\n"
    "  .csv   voxels, volume, area and heights of each class\n"
    "Only an archive knows which space is free. Of a folder or a .pcd, which hold what "
    "is\n"
    "occupied, octrees leave all else unknown, and occupancy grids take for free "
    "where\n"
    "ground is seen and nothing stands. Parts of an archive: pcl_semantic_archive "
    "export.",
    "pcl_semantic_synthesize /tmp/street && \\\n"
    "  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output /tmp/map \\\n"
    "    --archive /tmp/street_map && \\\n"
    "  pcl_semantic_export /tmp/street_map /tmp/street.bt && \\\n"
    "  pcl_semantic_export /tmp/map /tmp/street.ply --format mesh && \\\n"
    "  pcl_semantic_export /tmp/map /tmp/street.pgm --format traversability \\\n"
    "    --traversable road"};

struct FormatName {
  ExportFormat format;
  const char* name;
  const char* extension;
};

// Of one extension, the first is meant if none is named.
constexpr FormatName formats[] = {
    {ExportFormat::octree, "octree", ".bt"},
    {ExportFormat::colour_octree, "colour-octree", ".ot"},
    {ExportFormat::points, "points", ".ply"},
    {ExportFormat::mesh, "mesh", ".ply"},
    {ExportFormat::occupancy, "occupancy", ".pgm"},
    {ExportFormat::traversability, "traversability", ".pgm"},
    {ExportFormat::statistics, "statistics", ".csv"}};

ExportFormat
formatOf(const std::string& output, const std::string& name)
{
  const std::string extension = std::filesystem::path(output).extension().string();
  for (const FormatName& format : formats) {
    if (name.empty() ? extension != format.extension : name != format.name)
      continue;
    requireOutput(output, format.extension);
    return format.format;
  }
  if (name.empty())
    failUsage(usage, output + ": expected a name that ends in .bt, .ot, .ply, .pgm or "
                              ".csv");
  failUsage(usage, "--format is '" + name +
                       "', expected octree, colour-octree, points, mesh, occupancy, "
                       "traversability or statistics");
}

std::vector<std::string>
namesOf(const std::string& text)
{
  std::vector<std::string> names;
  std::istringstream stream(text);
  for (std::string name; std::getline(stream, name, ',');)
    names.push_back(name);
  return names;
}

// Options that the format has no use for were meant for something else.
void
refuseOthers(const po::variables_map& values, const std::vector<const char*>& options,
             const std::string& formats_of_them)
{
  for (const char* const option : options)
    if (values.count(option) && !values[option].defaulted())
      failUsage(usage, std::string("--") + option + " is for " + formats_of_them);
}

void
refuseUnused(const po::variables_map& values, ExportFormat format)
{
  if (format != ExportFormat::occupancy && format != ExportFormat::traversability)
    refuseOthers(values, {"ground", "min-height", "max-height", "ground-reach"},
                 "occupancy and traversability");
  if (format != ExportFormat::traversability)
    refuseOthers(values, {"traversable"}, "traversability");
  if (format != ExportFormat::points && format != ExportFormat::mesh &&
      format != ExportFormat::colour_octree)
    refuseOthers(values, {"colour"}, "points, mesh and colour-octree");
}

/** \brief Options as they are typed. */
struct Texts {
  std::string format, colour = "class", ground, traversable;
};

po::options_description
optionsOf(ExportArguments& arguments, Texts& texts)
{
  po::options_description options("Options");
  options.add_options()("map", po::value(&arguments.map), "the map")(
      "output", po::value(&arguments.output),
      "output file")("format", po::value(&texts.format),
                     "octree, colour-octree, points, mesh, occupancy, traversability "
                     "or statistics (default: by the name of the output)")(
      "label-set", po::value(&arguments.hints.label_set),
      "label set (YAML; default: that of the archive, or label_sets/kitti11.yaml)")(
      "voxel-size", po::value(&arguments.hints.voxel_size),
      "voxel size [m] (default: that of the map, or of its points)")(
      "ground", po::value(&texts.ground),
      "ground classes, separated by commas (default: road, sidewalk, terrain, parking "
      "and other ground, if there are such)")(
      "traversable", po::value(&texts.traversable),
      "traversable classes of the ground (default: road, sidewalk and parking)");
  addOption(options, "colour", texts.colour,
            "colour of points and meshes: class or rgb");
  addOption(options, "min-height", arguments.min_height,
            "minimum height of an obstacle above the ground [m]");
  addOption(options, "max-height", arguments.max_height,
            "maximum height of an obstacle above the ground [m]");
  addOption(options, "ground-reach", arguments.reach,
            "distance over which the height of the ground is extrapolated [m]");
  return options;
}

void
validate(const ExportArguments& arguments, const Texts& texts)
{
  std::vector<std::string> outputs = {arguments.output};
  if (arguments.format == ExportFormat::occupancy ||
      arguments.format == ExportFormat::traversability)
    outputs.push_back(gridDescription(arguments.output));
  refuseSameFiles({arguments.map, arguments.hints.label_set}, outputs);
  if (texts.colour != "class" && texts.colour != "rgb")
    failUsage(usage, "--colour is '" + texts.colour + "', expected class or rgb");
  if (!(arguments.hints.voxel_size >= 0.0))
    failUsage(usage, "--voxel-size is less than 0");
  if (!(arguments.min_height >= 0.0 && arguments.max_height > arguments.min_height))
    failUsage(usage, "expected 0 <= --min-height < --max-height");
  if (!(arguments.reach >= 0.0))
    failUsage(usage, "--ground-reach is less than 0");
}

} // namespace

bool
parseExportArguments(int argc, char** argv, ExportArguments& arguments)
{
  Texts texts;
  const po::options_description options = optionsOf(arguments, texts);
  po::positional_options_description positional;
  positional.add("map", 1).add("output", 1);
  po::variables_map values;
  if (!parseCommandLine(argc, argv, usage, options, positional, values))
    return false;
  if (arguments.map.empty() || arguments.output.empty())
    failUsage(usage, "MAP or OUT is missing");
  arguments.format = formatOf(arguments.output, texts.format);
  refuseUnused(values, arguments.format);
  validate(arguments, texts);
  arguments.measured_colours = texts.colour == "rgb";
  arguments.ground = namesOf(texts.ground);
  arguments.traversable = namesOf(texts.traversable);
  arguments.hints.free_space = arguments.format == ExportFormat::octree ||
                               arguments.format == ExportFormat::colour_octree ||
                               arguments.format == ExportFormat::occupancy;
  return true;
}

} // namespace pcl_semantic::tool

namespace {

using namespace pcl_semantic;
using tool::ExportArguments;
using tool::ExportFormat;
using tool::MapInput;
using tool::Results;

void
requireLabels(const MapInput& map)
{
  if (!map.scene.has_labels)
    PCL_THROW_EXCEPTION(BadInputException,
                        "has no labels, expected a field label or probability");
}

// Those of classes as they are: pictures have lighter ones.
std::vector<cv::Vec3b>
coloursOf(const ExportArguments& arguments, const MapInput& map)
{
  if (arguments.measured_colours)
    return measuredColours(map.scene).colours;
  requireLabels(map);
  std::vector<cv::Vec3b> colours;
  colours.reserve(map.scene.voxels.size());
  for (const pcl::PointXYZRGBL& point : *map.scene.voxels.cloud)
    colours.push_back(classColour(map.label_set, static_cast<Label>(point.label)));
  return colours;
}

// The classes that an option names; if it is not given, what there is of the usual
// ones.
std::vector<Label>
labelsOf(const char* option, const std::vector<std::string>& names,
         const std::vector<std::string>& usual, const LabelSet& label_set)
{
  std::vector<Label> labels;
  for (const std::string& name : names.empty() ? usual : names) {
    const Label label = label_set.find(name);
    if (label != kUnlabelled)
      labels.push_back(label);
    else if (!names.empty())
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          option << ": the label set has no class '" << name << "'");
  }
  if (labels.empty())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        option << ": the label set has no usual class of the ground; "
                                  "name those that are");
  return labels;
}

OccupancyGrid
gridOf(const ExportArguments& arguments, const MapInput& map)
{
  requireLabels(map);
  OccupancyGridParameters parameters;
  parameters.min_height = arguments.min_height;
  parameters.max_height = arguments.max_height;
  parameters.reach = arguments.reach;
  parameters.ground = labelsOf(
      "--ground", arguments.ground,
      {"road", "sidewalk", "terrain", "parking", "other ground"}, map.label_set);
  if (arguments.format == ExportFormat::occupancy)
    return occupancyGrid(map.scene, parameters);
  parameters.traversable = labelsOf("--traversable", arguments.traversable,
                                    {"road", "sidewalk", "parking"}, map.label_set);
  // What one goes on is ground.
  parameters.ground.insert(parameters.ground.end(), parameters.traversable.begin(),
                           parameters.traversable.end());
  return traversabilityGrid(map.scene, parameters);
}

Results
writeGrid(const ExportArguments& arguments, const MapInput& map)
{
  const OccupancyGrid grid = gridOf(arguments, map);
  writeOccupancyGrid(arguments.output, grid);
  return {{"columns", std::size_t(grid.cells.cols)},
          {"rows", std::size_t(grid.cells.rows)},
          {"description", gridDescription(arguments.output)}};
}

Results
writeMesh(const ExportArguments& arguments, const MapInput& map)
{
  const std::vector<cv::Vec3b> colours = coloursOf(arguments, map);
  const VoxelMesh mesh = blockyMesh(map.scene, colours);
  writePlyMesh(arguments.output, mesh, map.scene, colours);
  return {{"vertices", mesh.corners.size()}, {"faces", mesh.faces.size()}};
}

Results
writeTree(const ExportArguments& arguments, const MapInput& map)
{
  const VoxelScene& scene = map.scene;
  if (arguments.format == ExportFormat::octree)
    writeOctree(arguments.output, scene);
  else
    writeColourOctree(arguments.output, scene, coloursOf(arguments, map));
  const Eigen::Vector3d shift = octreeShift(scene);
  if (shift.cwiseAbs().maxCoeff() > 1e-3 * scene.grid.size) {
    std::ostringstream text;
    text << "the map is moved by " << shift.transpose()
         << " m: voxels of an octree begin at multiples of their size";
    tool::warn(text.str());
  }
  if (scene.knows_free)
    return {{"free_voxels", scene.free.size()}};
  return {{"free_space", std::string("not known, the map is no archive")}};
}

Results
write(const ExportArguments& arguments, const MapInput& map)
{
  switch (arguments.format) {
  case ExportFormat::octree:
  case ExportFormat::colour_octree:
    return writeTree(arguments, map);
  case ExportFormat::points:
    writePlyPoints(arguments.output, map.scene, coloursOf(arguments, map));
    break;
  case ExportFormat::mesh:
    return writeMesh(arguments, map);
  case ExportFormat::occupancy:
  case ExportFormat::traversability:
    return writeGrid(arguments, map);
  case ExportFormat::statistics:
    requireLabels(map);
    writeClassStatistics(arguments.output, countClasses(map.scene, map.label_set),
                         map.label_set);
    break;
  }
  return {};
}

int
exportMap(const ExportArguments& arguments)
{
  const MapInput map = tool::readMap(arguments.map, arguments.hints);
  tool::note(std::to_string(map.scene.voxels.size()) + " voxels are read");
  Results results = {{"file", arguments.output}, {"voxels", map.scene.voxels.size()}};
  try {
    for (const auto& result : write(arguments, map))
      results.push_back(result);
  }
  catch (const BadInputException& error) {
    PCL_THROW_EXCEPTION(BadInputException, arguments.map << ": " << error.what());
  }
  tool::printResults(results);
  return tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run("pcl_semantic_export", [&] {
    ExportArguments arguments;
    return tool::parseExportArguments(argc, argv, arguments) ? exportMap(arguments)
                                                             : int(tool::exit_done);
  });
}
