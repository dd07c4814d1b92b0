/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "archive_arguments.h"
#include "progress_bar.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/io/archive_merge.h>
#include <pcl_semantic/io/map_archive.h>
#include <pcl_semantic/io/map_export.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <sstream>

namespace {

using namespace pcl_semantic;

using Arguments = tool::ArchiveArguments;

[[noreturn]] void
failUsage(const std::string& message)
{
  tool::failUsage(tool::archive_usage, message);
}

BlockProgress
showProgress(const std::string& what)
{
  const auto bar = std::make_shared<std::optional<tool::ProgressBar>>();
  return [what, bar](std::size_t, std::size_t blocks) {
    if (!*bar)
      bar->emplace(what, blocks, "blocks");
    (*bar)->step();
  };
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
  const ArchiveExtent extent = archiveExtent(archive, showProgress("reading"));
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
  const std::vector<std::string> faults =
      verifyArchive(onlyFile(arguments), showProgress("verifying"));
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
  const std::size_t voxels =
      exportVoxels(archive, selection, arguments.files[1], VoxelColour::measured,
                   showProgress("exporting"));
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
  const std::uint64_t blocks =
      mergeArchives(inputs, arguments.files.back(), showProgress("merging"));
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
  if (command->second != exportCloud &&
      !(arguments.box.empty() && arguments.classes.empty()))
    failUsage("--box and --class are for 'export'");
  return command->second(arguments);
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run(tool::archive_usage.name, [&] {
    Arguments arguments;
    return tool::parseArchiveArguments(argc, argv, arguments) ? runCommand(arguments)
                                                              : int(tool::exit_done);
  });
}
