// SPDX-License-Identifier: BSD-3-Clause
#include "image_tool.h"
#include "live_source.h"
#include "live_view.h"
#include "map_watch.h"
#include "messages.h"
#include "network_trial.h"
#include "recorded_map.h"
#include "tool.h"

#include <pcl_semantic/capture/live_capture.h>
#include <pcl_semantic/capture/video_pair_sequence.h>
#include <pcl_semantic/core/threads.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

using Clock = std::chrono::steady_clock;

// Whether a periodic event is due.
class NowAndThen {
public:
  explicit NowAndThen(Clock::duration period) : period_(period) {}

  bool
  isDue()
  {
    if (Clock::now() < next_)
      return false;
    next_ = Clock::now() + period_;
    return true;
  }

private:
  Clock::duration period_;
  Clock::time_point next_{};
};

// Figures of the run, for the status line and the results.
class LiveFigures {
public:
  void
  add(const MappedFrame& mapped, double latency)
  {
    latencies_.push_back(float(latency));
    const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    text_ = "frame " + std::to_string(mapped.frame.number) + ": " +
            shown(double(latencies_.size()) / seconds) + " frames/s, " +
            shown(latency) + " s after it came, " +
            std::to_string(mapped.voxels.size()) + " voxels";
  }

  const std::string&
  text() const
  {
    return text_;
  }

  std::size_t
  frames() const
  {
    return latencies_.size();
  }

  double
  latency(double fraction) const
  {
    if (latencies_.empty())
      return 0.0;
    std::vector<float> sorted = latencies_;
    std::sort(sorted.begin(), sorted.end());
    return double(sorted[std::size_t(fraction * double(sorted.size() - 1) + 0.5)]);
  }

private:
  static std::string
  shown(double value)
  {
    return std::to_string(value).substr(0, 4);
  }

  Clock::time_point start_ = Clock::now();
  std::vector<float> latencies_; // [s], four bytes per frame
  std::string text_;
};

class LiveWatch : public MapWatch {
public:
  explicit LiveWatch(const MapOptions& options)
      : MapWatch(options.inputs.poses, options.inputs.sequence.strict),
        is_watched_(options.view), view_(std::chrono::milliseconds(500))
  {}

  void
  follow(const MapRun& run, const LiveSource& source)
  {
    run_ = &run;
    source_ = &source;
  }

  bool
  isWatched() override
  {
    return is_watched_ && view_.isDue();
  }

  void
  onMapped(const SensorFrame& /*frame*/, const MappedFrame& mapped) override
  {
    figures_.add(mapped, source_->secondsSinceGrabbed());
    status_.show(figures_.text() + ", " + std::to_string(run_->framesLabelledLate()) +
                 " labelled, " + std::to_string(source_->dropped()) + " dropped");
  }

  const LiveFigures&
  figures() const
  {
    return figures_;
  }

private:
  bool is_watched_;
  NowAndThen view_;
  const MapRun* run_ = nullptr;
  const LiveSource* source_ = nullptr;
  LiveFigures figures_;
  StatusLine status_{"live"};
};

std::unique_ptr<FrameSequence>
openVideos(const ImagePairFiles& files)
{
  auto videos = std::make_unique<VideoPairSequence>(files);
  warnOf(videos->doubts());
  return videos;
}

int
mapEveryFrame(const MapOptions& options)
{
  const ImagePairFiles& files = options.inputs.sequence.files;
  refuseIf(!isVideo(files.left) || !isVideo(files.right),
           "--every-frame needs videos for --left and --right; pcl_semantic_map maps "
           "sequences of images");
  printResults(
      mapRecording(options, openInputsOf(options.inputs, options.config, openVideos)));
  return interrupted() ? exit_interrupted : exit_done;
}

void
requireCaptures(const SequenceFiles& sequence)
{
  const auto isLive = [](const std::string& name) {
    return isCapture(name) || isVideo(name);
  };
  refuseIf(sequence.hasFiles() &&
               !(isLive(sequence.files.left) && isLive(sequence.files.right)),
           "expected cameras, streams or videos for --left and --right, or a SEQUENCE");
}

// Maps live pairs until they end or an interrupt arrives.
void
mapLive(const MapOptions& options)
{
  setNumberOfThreads(options.config.threads);
  catchInterruptsOfMap();
  const LiveSource* source = nullptr;
  InputOpeners openers;
  openers.network = openTriedNetwork;
  openers.live = [&](const MapInputs& inputs) {
    auto opened = std::make_unique<LiveSource>(inputs);
    source = opened.get();
    return opened;
  };
  LiveWatch watch(options);
  MapRun run(openInputs(options.inputs, options.config, openers), options.config,
             options.outputs, &watch);
  watch.follow(run, *source);
  run.labelLate();
  if (options.view)
    openLiveView(options.outputs.folder, options.inputs.sequence.folder);
  run.run();
  const LiveFigures& figures = watch.figures();
  printResults({{"frames", figures.frames()},
                {"labelled", std::size_t(run.framesLabelledLate())},
                {"dropped", std::size_t(source->dropped())},
                {"damaged", std::size_t(source->damaged())},
                {"latency_median", figures.latency(0.5)},
                {"latency_95", figures.latency(0.95)},
                {"map", options.outputs.folder + "/map.pcd"},
                {"top_view", options.outputs.folder + "/top_view.png"},
                {"figures", options.outputs.folder + "/summary.json"}});
}

} // namespace

int
main(int argc, char** argv)
{
  if (const auto trial = runAsNetworkTrial(argc, argv))
    return *trial;
  return runWithImages("pcl_semantic_live", [&] {
    keepFreedMemory();
    const MapOptions options = parseMapOptions(argc, argv, MapProgram::live);
    if (options.every_frame)
      return mapEveryFrame(options);
    if (options.inputs.rgbd.folder.empty())
      requireCaptures(options.inputs.sequence);
    restartWithShortSpins(argv);
    mapLive(options);
    return int(exit_done);
  });
}
