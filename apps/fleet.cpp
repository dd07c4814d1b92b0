// SPDX-License-Identifier: BSD-3-Clause
#include "core/text_stream.h"
#include "files/folder_lock.h"
#include "map_watch.h"
#include "messages.h"
#include "network_trial.h"
#include "ranks.h"
#include "recorded_map.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/io/archive_merge.h>
#include <pcl_semantic/io/map_archive.h>
#include <pcl_semantic/io/submaps.h>
#include <pcl_semantic/pipeline/fleet_plan.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sstream>

namespace {

namespace fs = std::filesystem;

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

const Usage usage{
    "pcl_semantic_fleet", "PLAN.yaml",
    R"(Maps many drives into one map: cuts them into submaps, maps these, moves each to its
corrected poses if there are any, and merges them tile by tile. Under mpirun or Slurm
all processes share the work. A restarted run keeps finished submaps. Submaps that
differ from the plan are mapped again or removed. OUTPUT/map.tiles is the map:
pcl_semantic_archive, _export, _render and _view read it as an archive.)",
    R"(pcl_semantic_synthesize /tmp/street && cat >/tmp/plan.yaml <<'EOF'
output: city
options: {submap_every: 10m}
drives:
  - {name: begin, sequence: street, labels: street/labels, frames: ':1'}
  - {name: rest, sequence: street, labels: street/labels, frames: '1:'}
EOF
pcl_semantic_fleet /tmp/plan.yaml && \
  pcl_semantic_archive info /tmp/city/map.tiles)"};

// The task to map one submap.
struct Task {
  MapOptions run;
  std::string corrected_poses;
  std::uint64_t digest = 0; // of the archive, after mapping

  const std::string&
  archive() const
  {
    return run.outputs.archive.path;
  }

  Submap
  submap() const
  {
    return {archive(), corrected_poses, digest};
  }
};

ArchiveHeader
headerOf(const MappingRun& run)
{
  return {run.label_set, run.config.map.withWindow(), {}};
}

// Checks before mapping that the submaps can be merged.
void
requireSame(const MappingRun& first, const MappingRun& other)
{
  const std::string difference = differenceOf(headerOf(first), headerOf(other));
  if (!difference.empty())
    fail<InvalidParameterException>("has another ", difference,
                                    " than the first drive");
}

template <typename Body>
auto
ofDrive(const FleetDrive& drive, Body&& body)
{
  const std::string where = "drive '" + drive.name + "': ";
  try {
    return body();
  }
  catch (const InvalidParameterException& error) {
    fail<InvalidParameterException>(where, error.what());
  }
  catch (const BadInputException& error) {
    fail<BadInputException>(where, error.what());
  }
}

// Opens every drive of a plan and cuts it into submaps.
// Returns "D A:B" for each submap: drive D of the plan, frames A to B - 1.
std::vector<std::string>
cut(const FleetPlan& plan)
{
  std::vector<std::string> stretches;
  std::optional<MappingRun> first;
  for (std::size_t d = 0; d < plan.drives.size(); ++d)
    ofDrive(plan.drives[d], [&] {
      const FleetDrive& drive = plan.drives[d];
      MapperConfig config = drive.config;
      config.validate();
      drive.inputs.validate(config);
      const SubmapLength length = parseSubmapLength(drive.submap_every, drive.inputs);
      OpenedInputs inputs = openInputsOf(drive.inputs, config);
      const std::vector<SubmapFrames> submaps = cutIntoSubmaps(inputs, length);
      MapWatch watch(drive.inputs.poses, drive.inputs.sequence.strict);
      const MappingRun whole =
          MapRun(std::move(inputs), config, {}, &watch).description();
      if (first)
        requireSame(*first, whole);
      else
        first = whole;
      std::vector<FrameTime> anchors;
      for (const SubmapFrames& submap : submaps) {
        anchors.push_back(submap.anchor);
        stretches.push_back(std::to_string(d) + " " + submap.range);
      }
      std::vector<std::string> doubts;
      if (!drive.corrected_poses.empty())
        correctedPoses(describeRun(whole), drive.corrected_poses, &doubts)
            .requirePoses(anchors);
      warnOf(doubts);
    });
  return stretches;
}

std::vector<Task>
tasksOf(const FleetPlan& plan, const std::vector<std::string>& stretches)
{
  std::vector<Task> tasks;
  for (const std::string& stretch : stretches) {
    std::size_t d = 0;
    std::string frames;
    std::istringstream(stretch) >> d >> frames;
    const FleetDrive& drive = plan.drives[d];
    Task task;
    task.corrected_poses = drive.corrected_poses;
    task.run.inputs = drive.inputs;
    task.run.inputs.frames = frames;
    task.run.config = drive.config;
    MapOutputs& outputs = task.run.outputs;
    outputs.folder = plan.output + "/submaps/" + drive.name;
    outputs = submapOutputs(outputs, frames);
    outputs.folder.clear(); // an archive only
    outputs.archive.resume = true;
    tasks.push_back(std::move(task));
  }
  return tasks;
}

// Durations of this rank's tasks.
class Log {
public:
  explicit Log(int rank) : rank_(rank) {}

  /** \param[in] body returns whether it had any work */
  template <typename Body>
  void
  time(const std::string& task, Body&& body)
  {
    const auto start = std::chrono::steady_clock::now();
    if (!body())
      return;
    const std::chrono::duration<double> seconds =
        std::chrono::steady_clock::now() - start;
    TextStream line;
    line << task << "," << rank_ << "," << seconds.count();
    lines_.push_back(line.str());
    note(task + ": " + std::to_string(seconds.count()) + " s");
  }

  const std::vector<std::string>&
  lines() const
  {
    return lines_;
  }

private:
  int rank_;
  std::vector<std::string> lines_;
};

// Returns the submaps of each tile. Each rank reads a part of the archives.
SubmapTiles
tilesOf(const std::vector<Task>& tasks, const Ranks& ranks)
{
  std::vector<std::string> own;
  for (std::size_t i = std::size_t(ranks.rank()); i < tasks.size();
       i += std::size_t(ranks.size()))
    for (const MapTile& tile : tilesOf(tasks[i].submap()))
      own.push_back(std::to_string(i) + " " + std::to_string(tile.y) + " " +
                    std::to_string(tile.x));
  std::map<MapTile, std::set<std::size_t>> reached; // tasks by tile
  for (const std::string& text : ranks.gather(own)) {
    std::size_t task = 0;
    MapTile tile;
    std::istringstream(text) >> task >> tile.y >> tile.x;
    reached[tile].insert(task);
  }
  SubmapTiles tiles;
  for (const auto& [tile, by] : reached)
    for (const std::size_t task : by)
      tiles[tile].push_back(tasks[task].submap());
  return tiles;
}

// Removes the tiles that are not in the map, for example those of an earlier plan.
void
removeOtherTiles(const std::string& index, const SubmapTiles& tiles)
{
  std::set<std::string> kept;
  for (const auto& [tile, submaps] : tiles)
    kept.insert(fs::path(tilePath(index, tile)).stem().string());
  for (const fs::directory_entry& file :
       fs::directory_iterator(fs::path(tilePath(index, {})).parent_path())) {
    const fs::path extension = file.path().extension();
    if ((extension == ".map" || extension == ".made") &&
        kept.count(file.path().stem().string()) == 0)
      fs::remove(file.path());
  }
}

// Removes the submaps that are not in the plan. The first frame names the archive of a
// submap.
void
removeOtherSubmaps(const std::string& folder, const std::vector<Task>& tasks)
{
  std::set<fs::path> kept;
  for (const Task& task : tasks)
    kept.insert(fs::path(task.archive()).lexically_normal());
  std::vector<fs::path> drives;
  std::error_code error;
  for (const fs::directory_entry& drive : fs::directory_iterator(folder, error))
    if (drive.is_directory(error) && !drive.is_symlink(error))
      drives.push_back(drive.path());
  for (const fs::path& drive : drives) {
    for (const FrameFile& file : listFrameFiles(drive.string(), {".map"}))
      if (kept.count(fs::path(file.path).lexically_normal()) == 0)
        removeArchive(file.path);
    fs::remove(drive, error); // fails if not empty
  }
}

// Writes the durations of all tasks. Tasks that this run has not repeated keep their
// durations from the old log.
void
writeLog(const std::string& path, const std::set<std::string>& tasks,
         const std::vector<std::string>& lines)
{
  const auto taskOf = [](const std::string& line) {
    return line.substr(0, line.rfind(',', line.rfind(',') - 1));
  };
  std::map<std::string, std::string> by_task;
  std::error_code error;
  std::ifstream old(fs::is_regular_file(path, error) ? path : "");
  std::string line;
  std::getline(old, line); // header
  while (std::getline(old, line))
    if (tasks.count(taskOf(line)) > 0)
      by_task[taskOf(line)] = line;
  for (const std::string& each : lines)
    by_task[taskOf(each)] = each;
  std::string text = "task,rank,seconds\n";
  for (const auto& [task, each] : by_task)
    text += each + "\n";
  writeTextFile(path, text);
}

void
stopIfInterrupted()
{
  if (interrupted())
    throw Exit{exit_interrupted};
}

// Maps the submaps that are missing or differ from the plan.
void
mapSubmaps(const Ranks& ranks, std::vector<Task>& tasks, Log& log)
{
  std::vector<std::string> digests;
  ranks.share(tasks.size(), [&](std::size_t i) {
    const std::string& archive = tasks[i].archive();
    log.time(archive, [&] { return mapIntoArchive(tasks[i].run); });
    stopIfInterrupted();
    digests.push_back(std::to_string(i) + " " + std::to_string(archiveDigest(archive)));
  });
  for (const std::string& text : ranks.gather(digests)) {
    std::size_t i = 0;
    std::uint64_t digest = 0;
    std::istringstream(text) >> i >> digest;
    tasks[i].digest = digest;
  }
}

FleetPlan
readPlanBeside(const std::string& path)
{
  FleetPlan plan = readFleetPlan(path);
  const std::string folder = fs::path(path).parent_path().string();
  if (!folder.empty())
    fs::current_path(folder); // paths in the plan are relative to it
  return plan;
}

int
mapFleet(const std::string& path, const Ranks& ranks)
{
  catchInterrupts();
  const bool is_first = ranks.rank() == 0;
  std::optional<FleetPlan> plan;
  std::optional<FolderLock> lock;
  std::vector<std::string> stretches;
  if (is_first) { // only one rank reports faults of the plan
    plan = readPlanBeside(path);
    stretches = cut(*plan);
    makeOutputFolder(plan->output + "/tiles");
    lock.emplace(plan->output);
  }
  ranks.broadcast(stretches);
  if (!is_first)
    plan = readPlanBeside(path);
  const std::string index = plan->output + "/map.tiles";
  std::vector<Task> tasks = tasksOf(*plan, stretches);
  Log log(ranks.rank());
  mapSubmaps(ranks, tasks, log);
  const SubmapTiles tiles = tilesOf(tasks, ranks);
  std::vector<MapTile> order;
  for (const auto& [tile, submaps] : tiles)
    order.push_back(tile);
  if (order.empty())
    fail<BadInputException>(path,
                            ": nothing was mapped: no frame of a drive has a depth");
  stopIfInterrupted();
  if (is_first)
    for (const std::string& file : {index, tiledObjectsPath(index)})
      fs::remove(file); // no index while the tiles belong to two maps
  ranks.wait();
  ranks.share(order.size(), [&](std::size_t i) {
    const std::string output = tilePath(index, order[i]);
    log.time(output, [&] { return mergeTile(tiles, order[i], output); });
    stopIfInterrupted();
  });
  const std::vector<std::string> lines = ranks.gather(log.lines());
  if (!is_first)
    return exit_done;
  removeOtherTiles(index, tiles);
  removeOtherSubmaps(plan->output + "/submaps", tasks);
  std::vector<Submap> submaps;
  for (const Task& task : tasks)
    submaps.push_back(task.submap());
  writeTileIndex(index, order);
  mergeTiledObjects(submaps, index);
  std::set<std::string> names;
  for (const Task& task : tasks)
    names.insert(task.archive());
  for (const MapTile& tile : order)
    names.insert(tilePath(index, tile));
  writeLog(plan->output + "/log.csv", names, lines);
  const fs::path folder = fs::path(path).parent_path();
  printResults({{"submaps", tasks.size()},
                {"tiles", order.size()},
                {"map", (folder / index).string()},
                {"log", (folder / plan->output / "log.csv").string()}});
  return exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  if (const auto trial = runAsNetworkTrial(argc, argv))
    return *trial;
  const Ranks ranks(argc, argv);
  const int code = run(usage.name, [&] {
    keepFreedMemory();
    std::string plan;
    parseCommandLine(
        argc, argv, usage,
        {{"plan", plan,
          "plan of the drives and their options (.yaml), see doc/fleet.md"}},
        {"plan"});
    refuseIf(plan.empty(), "PLAN.yaml is missing");
    return mapFleet(plan, ranks);
  });
  if (code != exit_done)
    ranks.stop(code);
  return code;
}
