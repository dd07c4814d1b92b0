// SPDX-License-Identifier: BSD-3-Clause
#include "live_mapping.h"
#include "live_source.h"
#include "live_view.h"
#include "map_judgement.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/pipeline/late_labels.h>
#include <pcl_semantic/pipeline/mapping_archive.h>
#include <pcl_semantic/pipeline/mapping_output.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <string>
#include <vector>

namespace pcl_semantic::tool {

namespace {

using Clock = std::chrono::steady_clock;

// Whether something is due that happens now and then.
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

// Figures of the run, for the status line and for the results.
class LiveFigures {
public:
  void
  add(const MappedFrame& mapped, double latency)
  {
    latencies_.push_back(float(latency));
    voxels_ = mapped.voxels.size();
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

  /** \brief After the last frame. */
  std::size_t
  voxels() const
  {
    return voxels_;
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
  std::vector<float> latencies_; // [s], four bytes a frame
  std::size_t voxels_ = 0;
  std::string text_;
};

// Until there are no more, or an interrupt comes.
void
mapFrames(LiveSource& source, SemanticMapper& mapper, LateLabels& labels,
          MappingArchive& archive, MappingOutput& output, bool is_watched,
          LiveFigures& figures)
{
  StatusLine status("live");
  NowAndThen view(std::chrono::milliseconds(500));
  while (const std::optional<SensorFrame> frame = source.next()) {
    labels.fuseReady();
    const MappedFrame mapped = mapper.process(*frame);
    labels.offer(mapped);
    output.writeFrame(mapped, mapper.map());
    archive.add(mapped, mapper);
    figures.add(mapped, source.secondsSinceGrabbed());
    if (is_watched && view.isDue())
      output.writeLive(mapped);
    status.show(figures.text() + ", " + std::to_string(labels.frames()) +
                " labelled, " + std::to_string(source.dropped()) + " dropped");
  }
}

} // namespace

int
mapLive(const MapArguments& arguments)
{
  requireMapArguments(arguments);
  setNumberOfThreads(arguments.parameters.threads);
  catchInterruptsOfMap();
  LiveSource source(arguments);
  std::vector<std::string> told; // by the source
  std::unique_ptr<PoseSource> owned_poses = source.openPoses(told);
  const PoseSource& poses = *owned_poses;
  MappingArchive archive(arguments.archive, source.run());
  const auto mapper = source.makeMapper(std::move(owned_poses), archive.store());
  LateLabels labels(source.takePredictor(), *mapper);
  MappingOutput output(arguments.output, source.run(), {}, source.extras());
  if (arguments.view)
    openLiveView(arguments.output, arguments.sequence.folder);
  LiveFigures figures;
  // What goes wrong ends the run, but not without the map so far.
  std::exception_ptr error;
  try {
    mapFrames(source, *mapper, labels, archive, output, arguments.view, figures);
    labels.fuseLast();
  }
  catch (...) {
    if (figures.frames() == 0)
      throw;
    error = std::current_exception();
  }
  if (error)
    archive.abandon(*mapper);
  else
    archive.finish(*mapper);
  output.finish(mapper->map(), !error);
  archive.close();
  if (error)
    std::rethrow_exception(error);
  if (figures.voxels() == 0)
    warnOfEmptyMap();
  judgeTracking(arguments.sequence.name(), poses.lostFrames(), int(figures.frames()));
  printResults({{"frames", figures.frames()},
                {"labelled", std::size_t(labels.frames())},
                {"dropped", std::size_t(source.dropped())},
                {"damaged", std::size_t(source.damaged())},
                {"latency_median", figures.latency(0.5)},
                {"latency_95", figures.latency(0.95)},
                {"map", arguments.output + "/map.pcd"},
                {"top_view", arguments.output + "/top_view.png"},
                {"figures", arguments.output + "/summary.json"}});
  return exit_done;
}

} // namespace pcl_semantic::tool
