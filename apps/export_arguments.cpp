// SPDX-License-Identifier: BSD-3-Clause
#include "export_arguments.h"

#include "tool.h"

#include <pcl_semantic/io/occupancy_grid.h>

#include <filesystem>
#include <sstream>

namespace pcl_semantic::tool {

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
    requireExtension(output, format.extension);
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
      "output", po::value(&arguments.output), "the file to write")(
      "format", po::value(&texts.format),
      "octree, colour-octree, points, mesh, occupancy, traversability, statistics; "
      "default: by the name of the output")(
      "label-set", po::value(&arguments.hints.label_set),
      "classes (YAML); default: an archive's own, or the eleven of KITTI")(
      "voxel-size", po::value(&arguments.hints.voxel_size),
      "edge of the voxels [m]; default: what the map says, or its points")(
      "ground", po::value(&texts.ground),
      "classes that the ground is made of: a,b,c; default: road, sidewalk, terrain, "
      "parking and other ground, if there are such")(
      "traversable", po::value(&texts.traversable),
      "classes of the ground to go on; default: road, sidewalk and parking");
  addOption(options, "colour", texts.colour, "class or rgb, of what has colours");
  addOption(options, "min-height", arguments.min_height,
            "above the ground: what is lower is no obstacle [m]");
  addOption(options, "max-height", arguments.max_height, "nor what is higher [m]");
  addOption(options, "ground-reach", arguments.reach,
            "how far from seen ground its height is taken for known [m]");
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
