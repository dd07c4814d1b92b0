// SPDX-License-Identifier: BSD-3-Clause
#include "recorded_mapping.h"
#include "live_view.h"
#include "map_judgement.h"
#include "map_source.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/io/map_archive.h>
#include <pcl_semantic/io/submaps.h>
#include <pcl_semantic/pipeline/mapping_archive.h>
#include <pcl_semantic/pipeline/mapping_output.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

namespace pcl_semantic::tool {

namespace {

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

Results
outputsOf(const MapArguments& arguments, const MapSource& source,
          const MappingArchive& archive)
{
  Results results;
  if (!archive.records().empty())
    results.push_back({"resumed_after", archive.records().size()});
  for (const auto& figure : source.figures())
    results.push_back(figure);
  results.push_back({"map", arguments.output + "/map.pcd"});
  results.push_back({"top_view", arguments.output + "/top_view.png"});
  if (source.run().camera && !arguments.map_only)
    results.push_back({"overlays", arguments.output + "/overlay"});
  results.push_back({"figures", arguments.output + "/summary.json"});
  if (!arguments.archive.path.empty())
    results.push_back({"archive", arguments.archive.path});
  return results;
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
// \return whether that is all of it now
bool
mapFrames(MapSource& source, SemanticMapper& mapper, MappingArchive& archive,
          MappingOutput* output, bool is_watched)
{
  const std::size_t mapped_before = archive.records().size();
  catchInterruptsOfMap();
  ProgressBar progress("mapping", source.run().frames.size() - mapped_before);
  bool is_empty = mapped_before == 0;
  PoseWatch watch(source.run().config.map.max_range);
  std::size_t mapped_now = mapped_before;
  while (!interrupted()) {
    const std::optional<SensorFrame> frame = source.next();
    if (!frame)
      break;
    ++mapped_now;
    MappedFrame mapped = mapper.process(*frame);
    mapped.times.measure("output", [&] {
      if (output)
        output->writeFrame(mapped, mapper.map());
      archive.add(mapped, mapper);
      if (output && is_watched)
        output->writeLive(mapped);
    });
    watch.look(mapped.frame.number, mapped.T_world_camera.translation());
    noteTimes(mapped);
    progress.step();
    is_empty = is_empty && mapped.voxels.size() == 0;
  }
  if (is_empty)
    warnOfEmptyMap();
  return mapped_now == source.run().frames.size();
}

// "50m" or "100", frames.
SubmapLength
parseSubmapLength(const std::string& text)
{
  SubmapLength length;
  const bool is_metres = !text.empty() && text.back() == 'm';
  const char* const end = text.data() + text.size() - (is_metres ? 1 : 0);
  double number = 0.0;
  const auto read = std::from_chars(text.data(), end, number);
  refuseIf(read.ec != std::errc() || read.ptr != end ||
               !(number > 0.0 && number <= 1e9) ||
               (!is_metres && number != std::floor(number)),
           "--submap-every is '" + text + "', expected metres (50m) or frames (100)");
  if (is_metres)
    length.metres = number;
  else
    length.frames = int(number);
  return length;
}

// What the archive of a submap holds.
struct MadeSubmap {
  std::vector<FrameRecord> frames;
  bool is_finished = false;
  std::string fault; // why it is not of its run, or cannot be read
};

MadeSubmap
lookInto(const std::string& path, const MappingRun& run)
{
  MadeSubmap made;
  try {
    const MapArchive archive(path, ArchiveAccess::read);
    made.fault = changeOfRun(archive.header().configuration, describeRun(run));
    archive.forEachFrame([&](int number, const std::vector<std::uint8_t>& bytes) {
      made.frames.push_back(decodeFrameRecord(number, bytes));
    });
    made.is_finished =
        archive.state().finished && made.frames.size() == run.frames.size();
    const std::vector<std::string> faults = verifyArchive(path);
    if (made.fault.empty() && !faults.empty())
      made.fault = faults.front();
  }
  catch (const BadInputException& error) {
    made.fault = error.what();
  }
  return made;
}

// Whether the archive of a submap holds all that its run would make now. One that holds
// something else, or is damaged, is removed.
bool
isMade(MapSource& source, const std::string& path)
{
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    removeArchive(path); // a log without its file
    return false;
  }
  MadeSubmap made = lookInto(path, source.run());
  if (made.fault.empty())
    made.fault = source.changeSince(made.frames);
  if (made.fault.empty())
    return made.is_finished;
  note(path + ": is made anew: " + made.fault);
  removeArchive(path);
  return false;
}

} // namespace

void
removeArchive(const std::string& path)
{
  for (const char* const ending : {"", "-wal", "-shm", "-journal"}) {
    std::error_code error;
    std::filesystem::remove(path + ending, error);
    if (error)
      fail<OutputException>(path + ending, ": cannot be removed: ", error.message());
  }
}

Results
mapRecorded(const MapArguments& arguments)
{
  requireMapArguments(arguments);
  setNumberOfThreads(arguments.parameters.threads);
  const std::unique_ptr<MapSource> source = openMapSource(arguments);
  const MappingRun& run = source->run();
  std::vector<std::string> doubts;
  std::unique_ptr<PoseSource> owned_poses = source->openPoses(doubts);
  const PoseSource& poses = *owned_poses;
  poses.requirePoses(source->times());
  warnOf(doubts);
  if (arguments.archive_only && isMade(*source, arguments.archive.path))
    return {};
  if (arguments.view)
    tool::openLiveView(arguments.output, arguments.sequence.folder);
  MappingArchive archive(arguments.archive, run);
  source->skip(archive.records());
  const auto mapper = source->makeMapper(std::move(owned_poses), archive.store());
  std::optional<MappingOutput> output;
  if (!arguments.archive_only)
    output.emplace(arguments.output, describedRun(arguments, *source),
                   archive.records(), source->extras());
  archive.resume(*mapper);
  const bool is_whole =
      mapFrames(*source, *mapper, archive, output ? &*output : nullptr, arguments.view);
  judgeTracking(arguments.sequence.name(), poses.lostFrames(), int(run.frames.size()));
  archive.finish(*mapper);
  if (output) {
    output->finish(mapper->map(), is_whole);
    judgeCalibration(arguments.label_calibration, output->domainShift());
  }
  if (!archive.close())
    warn(arguments.archive.path + ": is being read by another program: " +
         arguments.archive.path + "-wal still belongs to it");
  return outputsOf(arguments, *source, archive);
}

MapArguments
submapOf(const MapArguments& arguments, const std::string& frames)
{
  const std::string name = frameFileName(std::stoi(frames), "");
  MapArguments submap = arguments;
  submap.submap_every.clear();
  submap.frames = frames;
  submap.output = arguments.output + "/" + name;
  submap.archive.path = arguments.output + "/" + name + ".map";
  return submap;
}

SubmapRuns
submapsOf(const MapArguments& arguments)
{
  refuseIf(!arguments.archive.path.empty() || arguments.view,
           "--submap-every and --archive or --view exclude each other");
  MapArguments all = arguments;
  all.archive.path = arguments.output + "/submap"; // so that poses have to be a file's
  requireMapArguments(all);
  const SubmapLength length = parseSubmapLength(arguments.submap_every);
  const std::unique_ptr<MapSource> source = openMapSource(all);
  const std::vector<FrameTime> times = source->times();
  std::vector<std::string> doubts;
  const std::unique_ptr<PoseSource> poses = source->openPoses(doubts);
  poses->requirePoses(times);
  warnOf(doubts);
  std::vector<Eigen::Vector3d> positions;
  for (const FrameTime& time : times)
    positions.push_back(poseAt(*poses, time).translation());
  const std::vector<std::size_t> starts = submapStarts(positions, length);
  SubmapRuns submaps{{}, source->run()};
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const std::size_t last =
        i + 1 < starts.size() ? starts[i + 1] - 1 : times.size() - 1;
    submaps.anchors.push_back(times[starts[i] + (last - starts[i] + 1) / 2]);
    submaps.each.push_back(
        submapOf(arguments, std::to_string(times[starts[i]].number) + ":" +
                                std::to_string(times[last].number + 1)));
  }
  return submaps;
}

} // namespace pcl_semantic::tool
