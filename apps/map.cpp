/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "live_view.h"
#include "map_arguments.h"
#include "map_extras.h"
#include "map_labelling.h"
#include "map_poses.h"
#include "messages.h"
#include "pair_watch.h"
#include "progress_bar.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/dataset/frame_range.h>
#include <pcl_semantic/pipeline/mapping_archive.h>
#include <pcl_semantic/pipeline/mapping_output.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <filesystem>
#include <iostream>
#include <memory>

namespace {

using namespace pcl_semantic;

using tool::Labelling;
using tool::MapArguments;

// Everything that the map depends on.
MappingRun
makeRun(const MapArguments& arguments, const FrameSequence& sequence,
        const std::vector<std::size_t>& frames, const std::string& poses,
        const Labelling& labelling)
{
  MappingRun run;
  run.inputs = tool::inputsOf(arguments.sequence);
  run.inputs.insert(run.inputs.end(),
                    {{"poses", poses},
                     {"labels", arguments.labels},
                     {"network", arguments.network},
                     {"model", labelling.model},
                     {"label_calibration", arguments.label_calibration},
                     {"clique_calibration", arguments.clique_calibration}});
  for (const std::size_t i : frames)
    run.frames.push_back(sequence.frameNumber(i));
  run.camera = sequence.camera();
  run.T_camera0_camera = sequence.T_camera0_camera();
  run.label_set = labelling.label_set;
  run.config = arguments.parameters;
  return run;
}

MappingOutput
makeOutput(const MapArguments& arguments, const MappingRun& run,
           const std::string& poses, const MappingArchive& archive, ExtraOptions extra)
{
  auto inputs = tool::inputsOf(arguments.sequence);
  inputs.insert(inputs.end(), {{"frames", arguments.frames},
                               {"poses", poses},
                               {"labels", arguments.labels},
                               {"label_set", arguments.label_set},
                               {"network", arguments.network},
                               {"model", arguments.model},
                               {"label_calibration", arguments.label_calibration},
                               {"clique_calibration", arguments.clique_calibration},
                               {"archive", arguments.archive.path}});
  return {arguments.output,     run.camera,        run.label_set,     run.config,
          run.T_camera0_camera, std::move(inputs), archive.records(), std::move(extra)};
}

void
printResults(const MapArguments& arguments, const MappingArchive& archive)
{
  tool::Results results;
  if (!archive.records().empty())
    results.push_back({"resumed_after", archive.records().size()});
  results.push_back({"map", arguments.output + "/map.pcd"});
  results.push_back({"top_view", arguments.output + "/top_view.png"});
  results.push_back({"overlays", arguments.output + "/overlay"});
  results.push_back({"figures", arguments.output + "/summary.json"});
  if (!arguments.archive.path.empty())
    results.push_back({"archive", arguments.archive.path});
  tool::printResults(results);
}

void
noteTimes(const MappedFrame& mapped)
{
  std::string text = "frame " + std::to_string(mapped.frame.number);
  for (const auto& [stage, seconds] : mapped.times.seconds())
    text += ", " + stage + " " + std::to_string(std::lround(1e3 * seconds)) + " ms";
  tool::note(text + ", " + std::to_string(mapped.voxels.size()) + " voxels");
}

// Maps what the run has and the archive does not hold yet.
void
mapFrames(const FrameSequence& sequence, const MappingRun& run, bool strict,
          SemanticMapper& mapper, MappingArchive& archive, MappingOutput& output,
          tool::LiveView* view)
{
  tool::catchInterrupts();
  tool::PairWatch watch("pcl_semantic_map", strict);
  tool::ProgressBar progress("mapping", run.frames.size() - archive.records().size());
  for (std::size_t i = 0; i < sequence.size() && !tool::interrupted(); ++i) {
    const int frame = sequence.frameNumber(i);
    if (!run.contains(frame) || archive.holds(frame))
      continue;
    const StereoFrame pair = sequence.frame(i);
    watch.look(pair);
    const MappedFrame mapped = mapper.process(pair);
    output.writeFrame(mapped, mapper.map());
    archive.add(mapped, mapper);
    if (view)
      view->show(mapped);
    noteTimes(mapped);
    progress.step();
  }
}

void
judgeTracking(const MapArguments& arguments, const PoseSource& poses, int frames)
{
  const auto* const odometry = dynamic_cast<const StereoOdometry*>(&poses);
  const int lost = odometry ? odometry->lostFrames() : 0;
  if (lost == 0)
    return;
  if (lost + 1 == frames)
    PCL_THROW_EXCEPTION(BadInputException, arguments.sequence.name()
                                               << ": no frame could be tracked");
  tool::warn(std::to_string(lost) +
             " frames could not be tracked: their poses are predicted");
}

int
mapSequence(const MapArguments& arguments)
{
  tool::requireMapArguments(arguments);
  setNumberOfThreads(arguments.parameters.threads);
  const std::unique_ptr<FrameSequence> opened = tool::openSequence(arguments.sequence);
  const FrameSequence& sequence = *opened;
  const std::string chosen = tool::choosePoses(arguments, sequence);
  Labelling labelling = tool::makeLabelling(arguments);
  const std::vector<std::size_t> frames =
      tool::chooseFrames(arguments.sequence, sequence, arguments.frames);
  const MappingRun run = makeRun(arguments, sequence, frames, chosen, labelling);
  ExtraOptions extra = tool::makeExtras(arguments, sequence, frames);
  std::unique_ptr<PoseSource> owned_poses = tool::makePoses(chosen, sequence);
  const PoseSource& poses = *owned_poses;
  poses.requirePoses(frameTimes(sequence, frames));
  std::unique_ptr<tool::LiveView> view;
  if (arguments.view)
    view = std::make_unique<tool::LiveView>(run.camera, run.label_set);
  MappingArchive archive(arguments.archive, run);
  SemanticMapper mapper(run.camera, run.label_set, run.config,
                        std::move(labelling.predictor), std::move(owned_poses),
                        archive.store());
  if (labelling.calibration)
    mapper.setLabelCalibration(*labelling.calibration);
  if (labelling.clique_calibration)
    mapper.setCliqueCalibration(*labelling.clique_calibration);
  MappingOutput output = makeOutput(arguments, run, chosen, archive, std::move(extra));
  archive.resume(mapper);
  mapFrames(sequence, run, arguments.sequence.strict, mapper, archive, output,
            view.get());
  judgeTracking(arguments, poses, int(run.frames.size()));
  archive.finish(mapper);
  output.finish(mapper.map());
  if (view)
    view->finish(mapper.map());
  if (!archive.close())
    tool::warn(arguments.archive.path + ": is being read by another program: " +
               arguments.archive.path + "-wal still belongs to it");
  printResults(arguments, archive);
  return tool::interrupted() ? tool::exit_interrupted : tool::exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run("pcl_semantic_map", [&] {
    MapArguments arguments;
    if (!tool::parseMapArguments(argc, argv, arguments))
      return int(tool::exit_done);
    if (arguments.print_config) {
      std::cout << printMapperConfig(arguments.parameters);
      return int(tool::exit_done);
    }
    return mapSequence(arguments);
  });
}
