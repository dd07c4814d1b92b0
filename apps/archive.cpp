/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/io/archive_merge.h>
#include <pcl_semantic/io/map_archive.h>
#include <pcl_semantic/io/map_export.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <sstream>

namespace {

using namespace pcl_semantic;
namespace po = tool::po;

struct Arguments {
  std::string command;
  std::vector<std::string> files;
  std::string box;
  std::vector<std::string> classes;
};

const tool::Usage usage{
    "pcl_semantic_archive",
    "info FILE | verify FILE | export FILE OUT.pcd [--box ...] [--class NAME]... | "
    "merge FILE FILE... OUT",
    "Looks into the map archives of pcl_semantic_map --archive.\n"
    "  info    what is in it\n"
    "  verify  reads all of it and compares every checksum: prints 'ok' or what is "
    "wrong\n"
    "  export  its occupied voxels, as map.pcd holds them; x y z are relative to the\n"
    "          origin that info prints\n"
    "  merge   joins maps of the same frame of reference into a new archive OUT",
    "pcl_semantic_synthesize /tmp/street && \\\n"
    "  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output /tmp/map \\\n"
    "    --archive /tmp/street.map && \\\n"
    "  pcl_semantic_archive export /tmp/street.map /tmp/road.pcd --class road"};

[[noreturn]] void
failUsage(const std::string& message)
{
  PCL_THROW_EXCEPTION(InvalidParameterException,
                      message << " (see " << usage.name << " --help)");
}

bool
parse(int argc, char** argv, Arguments& arguments)
{
  po::options_description options("Options");
  options.add_options()("command", po::value(&arguments.command),
                        "info, verify, export or merge")(
      "files", po::value(&arguments.files), "archives, and what is written last")(
      "box", po::value(&arguments.box),
      "of export: XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX, world frame [m]")(
      "class", po::value(&arguments.classes),
      "of export: only voxels of this class; may be given several times");
  po::positional_options_description positional;
  positional.add("command", 1).add("files", -1);
  po::variables_map values;
  return tool::parseCommandLine(argc, argv, usage, options, positional, values);
}

const std::string&
onlyFile(const Arguments& arguments)
{
  if (arguments.files.size() != 1)
    failUsage("'" + arguments.command + "' needs one FILE");
  return arguments.files[0];
}

void
printHeader(const MapArchive& archive)
{
  const ArchiveHeader& header = archive.header();
  const ArchiveState state = archive.state();
  const Eigen::Vector3d& origin = state.cloud_origin;
  std::cout << "file:       " << archive.path() << ", "
            << std::filesystem::file_size(archive.path()) << " bytes\n"
            << "run:        " << (state.finished ? "finished" : "interrupted") << ", "
            << state.frames << " frames";
  if (state.frames > 0)
    std::cout << ", the last is " << state.last_frame;
  std::cout << "\nvoxel size: " << header.parameters.voxel_size
            << " m\norigin:     " << origin.x() << " " << origin.y() << " "
            << origin.z() << " m\nclasses:   ";
  for (int label = 1; label <= header.label_set.size(); ++label)
    std::cout << " " << header.label_set[Label(label)].name;
  std::cout << "\n";
}

int
info(const Arguments& arguments)
{
  const MapArchive archive(onlyFile(arguments), ArchiveAccess::read);
  const ArchiveExtent extent = archiveExtent(archive);
  printHeader(archive);
  std::cout << "blocks:     " << archive.state().blocks
            << "\noccupied:   " << extent.voxels << " voxels\n";
  if (extent.voxels > 0)
    std::cout << "extent:     " << extent.box.min().transpose() << " to "
              << extent.box.max().transpose() << " m\n";
  std::cout << "made from:\n" << archive.header().configuration;
  return tool::exit_done;
}

int
verify(const Arguments& arguments)
{
  const std::vector<std::string> faults = verifyArchive(onlyFile(arguments));
  for (const std::string& fault : faults)
    std::cout << fault << "\n";
  if (!faults.empty())
    PCL_THROW_EXCEPTION(BadInputException,
                        arguments.files[0] << ": " << faults.size() << " faults");
  std::cout << "ok\n";
  return tool::exit_done;
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
    if (!numbers || !(numbers >> std::ws).eof() || selection.box.isEmpty())
      failUsage("--box '" + arguments.box + "': expected two corners, six numbers");
  }
  for (const std::string& name : arguments.classes) {
    selection.labels.push_back(label_set.find(name));
    if (selection.labels.back() == kUnlabelled && name != "unlabelled")
      PCL_THROW_EXCEPTION(BadInputException,
                          arguments.files[0] << ": has no class '" << name << "'");
  }
  return selection;
}

int
exportCloud(const Arguments& arguments)
{
  if (arguments.files.size() != 2)
    failUsage("'export' needs FILE and OUT.pcd");
  tool::refuseSameFiles({arguments.files[0]}, {arguments.files[1]});
  const MapArchive archive(arguments.files[0], ArchiveAccess::read);
  const VoxelSelection selection = selectionOf(arguments, archive.header().label_set);
  const std::size_t voxels = exportVoxels(archive, selection, arguments.files[1]);
  std::cout << "voxels: " << voxels << "\n";
  return tool::exit_done;
}

int
merge(const Arguments& arguments)
{
  if (arguments.files.size() < 3)
    failUsage("'merge' needs two FILEs or more, and OUT");
  const std::vector<std::string> inputs(arguments.files.begin(),
                                        arguments.files.end() - 1);
  // A map that is given twice would be believed twice.
  tool::refuseSameFiles({}, arguments.files);
  const std::uint64_t blocks = mergeArchives(inputs, arguments.files.back());
  std::cout << "blocks: " << blocks << "\n";
  return tool::exit_done;
}

int
runCommand(const Arguments& arguments)
{
  static const std::map<std::string, int (*)(const Arguments&)> commands = {
      {"info", info}, {"verify", verify}, {"export", exportCloud}, {"merge", merge}};
  const auto command = commands.find(arguments.command);
  if (command == commands.end())
    failUsage("'" + arguments.command + "': expected info, verify, export or merge");
  if (arguments.command != "export" &&
      !(arguments.box.empty() && arguments.classes.empty()))
    failUsage("--box and --class are for 'export'");
  return command->second(arguments);
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run(usage.name, [&] {
    Arguments arguments;
    return parse(argc, argv, arguments) ? runCommand(arguments) : int(tool::exit_done);
  });
}
