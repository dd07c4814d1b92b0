// SPDX-License-Identifier: BSD-3-Clause
#include "image_tool.h"
#include "map_options.h"
#include "messages.h"
#include "network_trial.h"
#include "recorded_map.h"
#include "tool.h"

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

// Maps each section in a separate run, named by its first frame.
void
mapSubmaps(const MapOptions& options)
{
  const OpenedInputs inputs = openInputsOf(options.inputs, options.config);
  warnOf(inputs.doubts);
  std::size_t done = 0;
  for (const SubmapFrames& frames : cutIntoSubmaps(
           inputs, parseSubmapLength(options.submap_every, options.inputs))) {
    MapOptions submap = options;
    submap.inputs.frames = frames.range;
    submap.outputs = submapOutputs(options.outputs, frames.range);
    mapRecording(submap, openInputsOf(submap.inputs, submap.config));
    if (interrupted())
      return;
    ++done;
  }
  printResults({{"submaps", done}, {"archives", options.outputs.folder + "/*.map"}});
}

} // namespace

int
main(int argc, char** argv)
{
  if (const auto trial = runAsNetworkTrial(argc, argv))
    return *trial;
  return runWithImages("pcl_semantic_map", [&] {
    keepFreedMemory();
    const MapOptions options = parseMapOptions(argc, argv, MapProgram::map);
    if (options.submap_every.empty())
      printResults(mapRecording(options, openInputsOf(options.inputs, options.config)));
    else
      mapSubmaps(options);
    return interrupted() ? exit_interrupted : exit_done;
  });
}
