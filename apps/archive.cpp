// SPDX-License-Identifier: BSD-3-Clause
#include "core/text_stream.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/printable.h>
#include <pcl_semantic/files/object_file.h>
#include <pcl_semantic/files/plane_file.h>
#include <pcl_semantic/io/map_archive.h>
#include <pcl_semantic/io/map_changes.h>
#include <pcl_semantic/io/map_export.h>
#include <pcl_semantic/io/submaps.h>
#include <pcl_semantic/io/voxel_cloud_file.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

const Usage usage{
    "pcl_semantic_archive",
    "info FILE | verify FILE |\n  export FILE OUT.pcd [--box ...] [--class "
    "NAME]... |\n  merge FILE FILE... OUT | changes BEFORE AFTER OUT.pcd",
    R"(Inspects, exports and merges the map archives of pcl_semantic_map --archive.
  info    prints the contents of an archive
  verify  reads the whole archive and compares every checksum: prints 'ok' or the faults
  export  writes the occupied voxels as a cloud like map.pcd; x y z are relative to the
          origin that info prints, the boxes of --objects and --boxes to the world
  merge   joins maps in one frame of reference into a new archive OUT; --poses moves
          maps to that frame
  changes writes the voxels that are occupied in one map and free in the other: red if
          they disappeared, green if they appeared)",
    R"(pcl_semantic_synthesize /tmp/street && \
  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output /tmp/map \
    --archive /tmp/street.map && \
  pcl_semantic_archive export /tmp/street.map /tmp/road.pcd --class road)"};

struct Arguments {
  std::string command;
  std::vector<std::string> files;
  std::string box;                  ///< six numbers; empty = everything
  std::vector<std::string> classes; ///< empty = all
  std::vector<std::string> poses;   ///< corrected trajectories; empty = none
  std::string objects, boxes;       ///< files of export; empty = none
  std::string planes, polygons;     ///< the same
};

BlockProgress
showProgress(const std::string& what, const std::string& unit = "blocks")
{
  const auto bar = std::make_shared<std::optional<ProgressBar>>();
  return [what, unit, bar](std::size_t, std::size_t count) {
    if (!*bar)
      bar->emplace(what, count, unit);
    (*bar)->step();
  };
}

const std::string&
onlyFile(const Arguments& arguments)
{
  refuseIf(arguments.files.size() != 1, "'" + arguments.command + "' needs one FILE");
  return arguments.files[0];
}

std::string
textOf(const Eigen::Vector3d& position)
{
  TextStream text;
  text << position.transpose();
  return text.str();
}

int
info(const Arguments& arguments)
{
  const std::unique_ptr<MapReader> archive = MapReader::open(onlyFile(arguments));
  const ArchiveExtent extent = archiveExtent(*archive, showProgress("reading"));
  const ArchiveHeader& header = archive->header();
  const ArchiveState state = archive->state();
  std::string classes;
  for (int label = 1; label <= header.label_set.size(); ++label)
    classes += (label > 1 ? " " : "") + header.label_set[Label(label)].name;
  Results results = {
      {"file", archive->path()},
      {"bytes", std::size_t(std::filesystem::file_size(archive->path()))},
      {"run", std::string(state.finished ? "finished" : "interrupted")},
      {"frames", std::size_t(state.frames)}};
  if (state.frames > 0)
    results.push_back({"last_frame", std::size_t(state.last_frame)});
  results.push_back({"voxel_size", header.parameters.voxel_size});
  results.push_back({"origin", textOf(state.cloud_origin)});
  results.push_back({"classes", classes});
  results.push_back({"blocks", std::size_t(state.blocks)});
  if (archive->objects())
    results.push_back({"objects", describeObjects(*archive).size()});
  results.push_back({"occupied", std::size_t(extent.voxels)});
  if (extent.voxels > 0) {
    results.push_back({"from", textOf(extent.box.min())});
    results.push_back({"to", textOf(extent.box.max())});
  }
  results.push_back({"made_from", header.configuration});
  printFigures(results);
  return exit_done;
}

int
verify(const Arguments& arguments)
{
  const std::vector<std::string> faults =
      verifyArchive(onlyFile(arguments), showProgress("verifying"));
  for (const std::string& fault : faults)
    std::cout << printable(fault) << "\n";
  if (!faults.empty())
    fail<BadInputException>(arguments.files[0], ": ", faults.size(), " faults");
  printFigures("ok\n", "{\"faults\": 0}\n");
  return exit_done;
}

VoxelSelection
selectionOf(const Arguments& arguments, const LabelSet& label_set)
{
  VoxelSelection selection;
  if (!arguments.box.empty()) {
    std::string text = arguments.box;
    std::replace(text.begin(), text.end(), ',', ' ');
    std::istringstream numbers(text);
    for (Eigen::Vector3d* const corner : {&selection.box.min(), &selection.box.max()})
      numbers >> corner->x() >> corner->y() >> corner->z();
    refuseIf(!numbers || !(numbers >> std::ws).eof() || selection.box.isEmpty(),
             "--box '" + arguments.box + "': expected two corners, six numbers");
  }
  for (const std::string& name : arguments.classes) {
    selection.labels.push_back(label_set.find(name));
    if (selection.labels.back() == kUnlabelled && name != "unlabelled")
      fail<BadInputException>(arguments.files[0], ": has no class '", name, "'");
  }
  return selection;
}

// The files of --objects and --boxes.
void
writeThings(const MapReader& archive, const VoxelSelection& selection,
            const Arguments& arguments, Results& results)
{
  if (arguments.objects.empty() && arguments.boxes.empty())
    return;
  if (!archive.objects())
    fail<BadInputException>(archive.path(), ": has no objects");
  const std::vector<ObjectSummary> objects = describeObjects(archive, selection);
  const LabelSet& label_set = archive.header().label_set;
  results.push_back({"objects", objects.size()});
  if (!arguments.objects.empty())
    writeObjects(arguments.objects, objects, label_set);
  if (!arguments.boxes.empty())
    writeBoxes(arguments.boxes, objects, label_set);
}

// Planes follow from the selected voxels, which are in memory then. Returns the number
// of each voxel's plane, unless no planes are wanted.
std::optional<std::vector<std::uint32_t>>
writePlanesOf(const MapReader& archive, const VoxelSelection& selection,
              const Arguments& arguments, Results& results)
{
  requireOutput(arguments.planes, ".json");
  requireOutput(arguments.polygons, ".ply");
  if (arguments.planes.empty() && arguments.polygons.empty())
    return std::nullopt;
  const LabelSet& label_set = archive.header().label_set;
  const VoxelCloud voxels = readVoxels(archive, selection);
  CloudPlanes found = findPlanes(voxels.cloud, voxels.voxel_size, voxels.origin);
  results.push_back({"planes", found.planes.size()});
  if (!arguments.planes.empty())
    writePlanes(arguments.planes, found.planes, label_set);
  if (!arguments.polygons.empty())
    writePolygons(arguments.polygons, found.planes, label_set);
  return std::move(found.numbers);
}

int
exportCloud(const Arguments& arguments)
{
  refuseIf(arguments.files.size() != 2, "'export' needs FILE and OUT.pcd");
  refuseSameFiles({arguments.files[0]},
                  {arguments.files[1], arguments.objects, arguments.boxes,
                   arguments.planes, arguments.polygons});
  const std::unique_ptr<MapReader> archive = MapReader::open(arguments.files[0]);
  const VoxelSelection selection = selectionOf(arguments, archive->header().label_set);
  Results things;
  writeThings(*archive, selection, arguments, things);
  const std::optional<std::vector<std::uint32_t>> planes =
      writePlanesOf(*archive, selection, arguments, things);
  const std::size_t voxels =
      exportVoxels(*archive, selection, arguments.files[1], VoxelColour::measured,
                   showProgress("exporting"), planes ? &*planes : nullptr);
  Results results = {{"voxels", voxels}, {"cloud", arguments.files[1]}};
  results.insert(results.end(), things.begin(), things.end());
  printResults(results);
  return exit_done;
}

// The archives with their trajectories.
std::vector<Submap>
submapsOf(const Arguments& arguments, const std::vector<std::string>& inputs)
{
  const std::vector<std::string>& poses = arguments.poses;
  refuseIf(poses.size() > 1 && poses.size() != inputs.size(),
           "--poses is given once, or as often as there are FILEs");
  std::vector<Submap> submaps;
  for (const std::string& input : inputs) {
    Submap submap{input, poses.empty()       ? ""
                         : poses.size() == 1 ? poses[0]
                                             : poses[submaps.size()]};
    std::vector<std::string> doubts;
    submap.motion = placed(submap, &doubts).motion;
    warnOf(doubts);
    submaps.push_back(submap);
  }
  return submaps;
}

int
changes(const Arguments& arguments)
{
  refuseIf(arguments.files.size() != 3, "'changes' needs BEFORE, AFTER and OUT.pcd");
  const std::vector<std::string> maps(arguments.files.begin(),
                                      arguments.files.end() - 1);
  const std::string& output = arguments.files.back();
  refuseSameFiles(maps, {output});
  requireOutput(output, ".pcd");
  const std::vector<Submap> submaps = submapsOf(arguments, maps);
  const MapChanges found = findChanges(placed(submaps[0]), placed(submaps[1]));
  writeVoxelCloud(output, found.voxels, MapReader::open(maps[0])->header().label_set,
                  VoxelColour::measured);
  printFigures({{"went", found.went}, {"came", found.came}, {"cloud", output}});
  return exit_done;
}

int
merge(const Arguments& arguments)
{
  refuseIf(arguments.files.size() < (arguments.poses.empty() ? 3u : 2u),
           "'merge' needs two FILEs or more (with --poses one), and OUT");
  const std::vector<std::string> inputs(arguments.files.begin(),
                                        arguments.files.end() - 1);
  for (auto input = inputs.begin(); input != inputs.end(); ++input)
    refuseIf(std::any_of(input + 1, inputs.end(),
                         [&](const auto& other) { return areSameFile(*input, other); }),
             *input + ": is named twice, and would be believed twice");
  refuseSameFiles(inputs, {arguments.files.back()});
  const std::vector<Submap> submaps = submapsOf(arguments, inputs);
  const std::uint64_t blocks =
      mergeSubmaps(submaps, arguments.files.back(), showProgress("merging", "tiles"));
  printResults({{"blocks", std::size_t(blocks)}, {"archive", arguments.files.back()}});
  return exit_done;
}

Arguments
parse(int argc, char** argv)
{
  Arguments arguments;
  parseCommandLine(
      argc, argv, usage,
      {{"command", arguments.command,
        "command: info, verify, export, merge or changes"},
       {"files", arguments.files, "input archives, then the output file"},
       {"box", arguments.box,
        "box of export: XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX, world frame [m]"},
       {"class", arguments.classes,
        "class of the exported voxels; may be given several times"},
       {"objects", arguments.objects,
        "file for the objects of export (.json), see doc/things.md"},
       {"boxes", arguments.boxes, "file for the boxes of the objects of export (.ply)"},
       {"planes", arguments.planes,
        "file for the planes of export (.json), see doc/things.md"},
       {"polygons", arguments.polygons,
        "file for the outlines of the planes of export (.ply)"},
       {"poses", arguments.poses,
        "corrected trajectory (KITTI or TUM) for merge and changes; moves "
        "each map rigidly with the pose of its middle frame; one for all "
        "maps, or one for each FILE"}},
      {"command", "files..."});
  return arguments;
}

int
runCommand(const Arguments& arguments)
{
  static const std::map<std::string, int (*)(const Arguments&)> commands = {
      {"info", info},
      {"verify", verify},
      {"export", exportCloud},
      {"merge", merge},
      {"changes", changes}};
  const auto command = commands.find(arguments.command);
  refuseIf(command == commands.end(),
           "'" + arguments.command +
               "': expected info, verify, export, merge or changes");
  refuseIf(command->second != exportCloud &&
               !(arguments.box.empty() && arguments.classes.empty() &&
                 arguments.objects.empty() && arguments.boxes.empty() &&
                 arguments.planes.empty() && arguments.polygons.empty()),
           "--box, --class, --objects, --boxes, --planes and --polygons are for "
           "'export'");
  refuseIf(command->second != merge && command->second != changes &&
               !arguments.poses.empty(),
           "--poses is for 'merge' and 'changes'");
  return command->second(arguments);
}

} // namespace

int
main(int argc, char** argv)
{
  return run(usage.name, [&] { return runCommand(parse(argc, argv)); });
}
