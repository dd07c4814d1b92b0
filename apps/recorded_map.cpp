// SPDX-License-Identifier: BSD-3-Clause
#include "recorded_map.h"
#include "live_view.h"
#include "map_watch.h"
#include "network_trial.h"
#include "tool.h"

#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/input_file.h>

#include <optional>
#include <utility>

namespace pcl_semantic::tool {

namespace {

class RecordingWatch : public MapWatch {
public:
  RecordingWatch(const MapInputs& inputs, bool is_watched)
      : MapWatch(inputs.poses, inputs.sequence.strict), is_watched_(is_watched)
  {}

  void
  onBegin(std::size_t frames) override
  {
    catchInterruptsOfMap();
    progress_.emplace("mapping", frames);
  }

  bool
  isWatched() override
  {
    return is_watched_;
  }

  void
  onMapped(const SensorFrame& frame, const MappedFrame& mapped) override
  {
    MapWatch::onMapped(frame, mapped);
    progress_->step();
  }

private:
  bool is_watched_;
  std::optional<ProgressBar> progress_;
};

} // namespace

OpenedInputs
openInputsOf(const MapInputs& inputs, const MapperConfig& config,
             VideoOpener open_videos)
{
  setNumberOfThreads(config.threads);
  InputOpeners openers;
  openers.network = openTriedNetwork;
  openers.videos = std::move(open_videos);
  return openInputs(inputs, config, openers);
}

Results
mapRecording(const MapOptions& options, OpenedInputs inputs)
{
  MapOutputs outputs = options.outputs;
  outputs.summary = {{"frames", options.inputs.frames},
                     {"label_set", options.inputs.label_set},
                     {"archive", outputs.archive.path}};
  RecordingWatch watch(options.inputs, options.view);
  MapRun run(std::move(inputs), options.config, outputs, &watch);
  if (options.view)
    openLiveView(outputs.folder, options.inputs.sequence.folder);
  run.run();
  Results results;
  if (run.framesBefore() > 0)
    results.push_back({"resumed_after", run.framesBefore()});
  if (!options.inputs.rgbd.folder.empty())
    results.push_back({"pixels_without_depth", watch.unmeasured()});
  results.push_back({"map", outputs.folder + "/map.pcd"});
  results.push_back({"top_view", outputs.folder + "/top_view.png"});
  if (run.objects())
    results.push_back({"objects", outputs.folder + "/objects.json"});
  if (options.config.things)
    results.push_back({"planes", outputs.folder + "/planes.json"});
  if (options.inputs.hasCamera() && outputs.images)
    results.push_back({"overlays", outputs.folder + "/overlay"});
  results.push_back({"figures", outputs.folder + "/summary.json"});
  if (!outputs.archive.path.empty())
    results.push_back({"archive", outputs.archive.path});
  return results;
}

bool
mapIntoArchive(const MapOptions& options)
{
  RecordingWatch watch(options.inputs, false);
  MapRun run(openInputsOf(options.inputs, options.config), options.config,
             options.outputs, &watch);
  if (run.isMade())
    return false;
  run.run();
  return true;
}

MapOutputs
submapOutputs(const MapOutputs& outputs, const std::string& frames)
{
  const std::string name = frameFileName(std::stoi(frames), "");
  MapOutputs submap = outputs;
  submap.folder = outputs.folder + "/" + name;
  submap.archive.path = outputs.folder + "/" + name + ".map";
  return submap;
}

} // namespace pcl_semantic::tool
