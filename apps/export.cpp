// SPDX-License-Identifier: BSD-3-Clause
#include "export_arguments.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/io/class_statistics.h>
#include <pcl_semantic/io/occupancy_grid.h>
#include <pcl_semantic/io/octree_file.h>
#include <pcl_semantic/io/ply_file.h>
#include <pcl_semantic/io/voxel_colours.h>

#include <sstream>

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
