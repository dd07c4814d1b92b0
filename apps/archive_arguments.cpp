// SPDX-License-Identifier: BSD-3-Clause
#include "archive_arguments.h"

namespace pcl_semantic::tool {

const Usage archive_usage{
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

bool
parseArchiveArguments(int argc, char** argv, ArchiveArguments& arguments)
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
  return parseCommandLine(argc, argv, archive_usage, options, positional, values);
}

} // namespace pcl_semantic::tool
