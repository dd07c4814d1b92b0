// SPDX-License-Identifier: BSD-3-Clause
#include "live_mapping.h"
#include "live_view.h"
#include "map_arguments.h"
#include "map_judgement.h"
#include "map_source.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/pipeline/mapping_archive.h>
#include <pcl_semantic/pipeline/mapping_output.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <cmath>
#include <iostream>
#include <memory>

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

// What the summary says beyond what the map depends on.
MappingRun
describedRun(const MapArguments& arguments, const MapSource& source)
{
  MappingRun run = source.run();
  run.inputs.insert(run.inputs.end(), {{"frames", arguments.frames},
                                       {"label_set", arguments.label_set},
                                       {"archive", arguments.archive.path}});
  return run;
}

void
printOutputs(const MapArguments& arguments, const MapSource& source,
             const MappingArchive& archive)
{
  Results results;
  if (!archive.records().empty())
    results.push_back({"resumed_after", archive.records().size()});
  results.push_back({"map", arguments.output + "/map.pcd"});
  results.push_back({"top_view", arguments.output + "/top_view.png"});
  if (source.run().camera && !arguments.map_only)
    results.push_back({"overlays", arguments.output + "/overlay"});
  results.push_back({"figures", arguments.output + "/summary.json"});
  if (!arguments.archive.path.empty())
    results.push_back({"archive", arguments.archive.path});
  printResults(results);
}

void
noteTimes(const MappedFrame& mapped)
{
  std::string text = "frame " + std::to_string(mapped.frame.number);
  for (const auto& [stage, seconds] : mapped.times.seconds())
    text += ", " + stage + " " + std::to_string(std::lround(1e3 * seconds)) + " ms";
  note(text + ", " + std::to_string(mapped.voxels.size()) + " voxels");
}

// Maps what the run has and the archive does not hold yet.
void
mapFrames(MapSource& source, SemanticMapper& mapper, MappingArchive& archive,
          MappingOutput& output, bool is_watched)
{
  const std::size_t mapped_before = archive.records().size();
  source.skip(mapped_before);
  catchInterrupts();
  ProgressBar progress("mapping", source.run().frames.size() - mapped_before);
  bool is_empty = mapped_before == 0;
  while (!interrupted()) {
    const std::optional<SensorFrame> frame = source.next();
    if (!frame)
      break;
    MappedFrame mapped = mapper.process(*frame);
    mapped.times.measure("output", [&] {
      output.writeFrame(mapped, mapper.map());
      archive.add(mapped, mapper);
      if (is_watched)
        output.writeLive(mapped);
    });
    noteTimes(mapped);
    progress.step();
    is_empty = is_empty && mapped.voxels.size() == 0;
  }
  if (is_empty)
    warnOfEmptyMap();
}

int
mapSource(const MapArguments& arguments)
{
  requireMapArguments(arguments);
  setNumberOfThreads(arguments.parameters.threads);
  const std::unique_ptr<MapSource> source = openMapSource(arguments);
  const MappingRun& run = source->run();
  std::unique_ptr<PoseSource> owned_poses = source->openPoses();
  const PoseSource& poses = *owned_poses;
  poses.requirePoses(source->times());
  if (arguments.view)
    tool::openLiveView(arguments.output, arguments.sequence.folder);
  MappingArchive archive(arguments.archive, run);
  const auto mapper = source->makeMapper(std::move(owned_poses), archive.store());
  MappingOutput output(arguments.output, describedRun(arguments, *source),
                       archive.records(), source->extras());
  archive.resume(*mapper);
  mapFrames(*source, *mapper, archive, output, arguments.view);
  judgeTracking(arguments.sequence.name(), poses.lostFrames(), int(run.frames.size()));
  archive.finish(*mapper);
  output.finish(mapper->map());
  judgeCalibration(arguments.label_calibration, output.domainShift());
  if (!archive.close())
    warn(arguments.archive.path + ": is being read by another program: " +
         arguments.archive.path + "-wal still belongs to it");
  printOutputs(arguments, *source, archive);
  return interrupted() ? exit_interrupted : exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return run("pcl_semantic_map", [&] {
    keepFreedMemory();
    const MapArguments arguments = parseMapArguments(argc, argv);
    if (arguments.print_config) {
      std::cout << printMapperConfig(arguments.parameters);
      return int(exit_done);
    }
    if (!arguments.live)
      return mapSource(arguments);
    restartWithShortSpins(argv);
    return mapLive(arguments);
  });
}
