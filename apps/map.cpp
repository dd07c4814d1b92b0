// SPDX-License-Identifier: BSD-3-Clause
#include "image_tool.h"
#include "map_arguments.h"
#include "messages.h"
#include "network_trial.h"
#include "recorded_mapping.h"
#include "tool.h"

#include <iostream>

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

void
mapSubmaps(const MapArguments& arguments)
{
  std::size_t done = 0;
  for (const MapArguments& submap : submapsOf(arguments).each) {
    mapRecorded(submap);
    if (interrupted())
      return;
    ++done;
  }
  printResults({{"submaps", done}, {"archives", arguments.output + "/*.map"}});
}

int
mapFrames(const MapArguments& arguments)
{
  if (arguments.submap_every.empty())
    printResults(mapRecorded(arguments));
  else
    mapSubmaps(arguments);
  return interrupted() ? exit_interrupted : exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  if (const auto trial = runAsNetworkTrial(argc, argv))
    return *trial;
  return runWithImages("pcl_semantic_map", [&] {
    keepFreedMemory();
    const MapArguments arguments = parseMapArguments(argc, argv, MapProgram::map);
    if (arguments.print_config) {
      std::cout << printMapperConfig(arguments.parameters);
      return int(exit_done);
    }
    return mapFrames(arguments);
  });
}
