// SPDX-License-Identifier: BSD-3-Clause
#include "files/report_text.h"
#include "messages.h"
#include "sequence_options.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/dataset/lidar_scan.h>
#include <pcl_semantic/evaluation/map_geometry.h>
#include <pcl_semantic/evaluation/occupancy_reliability.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/io/cloud_sequence.h>
#include <pcl_semantic/io/map_archive.h>
#include <pcl_semantic/io/map_export.h>
#include <pcl_semantic/odometry/trajectory_poses.h>
#include <pcl_semantic/pipeline/map_folder.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <set>

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

namespace {

const Usage usage{
    "pcl_semantic_evaluate_map", "MAP {SEQUENCE | --clouds PATTERN} [options]",
    R"(Compares the geometry of a finished map (folder of pcl_semantic_map) with the laser scans
of its frames (velodyne/*.bin of the SEQUENCE, or clouds): how far voxels lie off the surface,
and how much of the surface is mapped. Of an archive or a map in tiles (map.tiles), merged from
many drives, the voxels around the poses of one SEQUENCE are compared.)",
    R"(pcl_semantic_map sequences/05 --frames 0:1 --labels labels_05 \
    --output /tmp/map_05 && pcl_semantic_evaluate_map /tmp/map_05 sequences/05)"};

struct Options {
  std::vector<std::string> maps, sequences, clouds, archives;
  std::string calibration, poses, frames = ":";
  std::string bands = "0,10,20,40";
  std::string output, row;
  bool header = false;
  GeometryParameters parameters;
};

// Numbers with commas between them.
std::vector<double>
parseBands(const std::string& text)
{
  std::vector<double> borders;
  try {
    for (const std::string& word : splitAtCommas(text))
      borders.push_back(parseNumber(word, "--bands"));
  }
  catch (const BadInputException& error) {
    failUsage(error.what());
  }
  return borders;
}

bool
isArchive(const std::string& map)
{
  return std::filesystem::is_regular_file(map);
}

Options
parse(int argc, char** argv)
{
  Options options;
  parseCommandLine(
      argc, argv, usage,
      {{"map", options.maps,
        "MAP; may be given several times, with as many sequences or clouds: they are "
        "evaluated as one"},
       {"sequence", options.sequences, "SEQUENCE of the map"},
       {"clouds", options.clouds,
        "clouds of the map instead, a folder or a pattern; may be given several times"},
       {"calibration", options.calibration,
        "of clouds mapped with --sensor laser: KITTI's calib.txt, with Tr"},
       {"poses", options.poses,
        "of a MAP that is an archive or an index of tiles: poses of camera 0, KITTI's "
        "or "
        "TUM's, in its frame (default: poses.txt of the SEQUENCE)"},
       {"frames", options.frames,
        "of such a MAP: the frames A:B of the SEQUENCE that it is compared with "
        "(default: "
        "those that the archive was made of, of a merged one all)"},
       {"archive", options.archives,
        "archive of the map of a SEQUENCE: judges its probabilities of occupancy, too, "
        "by "
        "the scans of frames that are not in the map; as many as MAP"},
       {"output,o", options.output, "output file for the figures (.json)"},
       {"row", options.row, "print one row of a Markdown table of this name"},
       {"header", options.header, "print the header of such a table"},
       {"bands", withDefault(options.bands),
        "limits of the bands of depth (of clouds: distance), separated by commas; "
        "points beyond the last do not count [m]"},
       {"within", withDefault(options.parameters.within),
        "distance of the widest of the shares of the surface [m]"},
       {"behind", withDefault(options.parameters.behind),
        "of a SEQUENCE: voxels farther behind the surface are hidden from the laser: "
        "not "
        "judged [m]"}},
      {"map", "sequence"});
  const bool has_clouds = !options.clouds.empty();
  refuseIf(has_clouds && !options.sequences.empty(),
           "SEQUENCE and --clouds exclude each other");
  refuseIf(options.maps.empty() ||
               options.maps.size() !=
                   (has_clouds ? options.clouds : options.sequences).size(),
           "expected MAP SEQUENCE, or MAP --clouds PATTERN, as many of both");
  refuseIf(has_clouds && !options.archives.empty(), "--archive is for a SEQUENCE");
  refuseIf(!options.archives.empty() && options.archives.size() != options.maps.size(),
           "expected as many of --archive as of MAP");
  refuseIf(!options.archives.empty() && (options.header || !options.row.empty()),
           "--archive and a table in Markdown exclude each other");
  refuseIf(!has_clouds && !options.calibration.empty(),
           "--calibration is for --clouds");
  const auto archives =
      std::count_if(options.maps.begin(), options.maps.end(), isArchive);
  refuseIf(archives > 0 && (has_clouds || !options.archives.empty()),
           "a MAP that is an archive is compared with a SEQUENCE, without --archive");
  refuseIf(
      archives == 0 && !(options.poses.empty() && options.frames == ":"),
      "--poses and --frames are for a MAP that is an archive: a folder knows its own");
  refuseIf(archives > 1 && !options.poses.empty(), "--poses is for one MAP");
  GeometryParameters& parameters = options.parameters;
  refuseIf(!(parameters.within >= 0.0 && parameters.within <= 2.0),
           "--within is " + shown(parameters.within) + ", expected 0 to 2");
  refuseIf(!(parameters.behind >= 0.0),
           "--behind is " + shown(parameters.behind) + ", expected 0 or more");
  refuseIf(manner().json && (options.header || !options.row.empty()),
           "--json and a table in Markdown exclude each other");
  parameters.bands = parseBands(options.bands);
  requireOutput(options.output, ".json");
  return options;
}

// What a map of many drives has around one of them.
MapFolder
readAround(const std::string& archive_path, const KittiSequence& sequence,
           const std::string& sequence_folder, const Options& options)
{
  SequenceOptions named;
  named.folder = sequence_folder;
  const std::string& path =
      options.poses.empty() ? sequence.posesPath() : options.poses;
  if (path.empty())
    fail<BadInputException>(sequence_folder, ": has no poses.txt, expected --poses");
  const std::unique_ptr<PoseSource> poses = readPoses(path);
  const MapArchive archive(archive_path, ArchiveAccess::read);
  MapFolder map;
  VoxelSelection around;
  around.box.setEmpty();
  std::set<int> mapped; // of one drive that was not merged
  archive.forEachFrame([&](int frame, const auto&) { mapped.insert(frame); });
  for (const std::size_t i : chooseFrames(named, sequence, options.frames)) {
    const int frame = sequence.frameNumber(i);
    if (options.frames == ":" && !mapped.empty() && mapped.count(frame) == 0)
      continue;
    const Eigen::Isometry3d pose = poseAt(*poses, {frame, sequence.timestamp(i)});
    map.frames.push_back(frame);
    map.T_world_camera0.resize(std::size_t(frame) + 1, Eigen::Isometry3d::Identity());
    map.T_world_camera0.back() = pose;
    around.box.extend(pose.translation());
  }
  // At the corners of a wide image a voxel is farther away than it is deep.
  const Eigen::Vector3d farthest =
      Eigen::Vector3d::Constant(2.0 * options.parameters.bands.back());
  around.box.extend((around.box.min() - farthest).eval());
  around.box.extend((around.box.max() + farthest).eval());
  map.voxels = readVoxels(archive, around);
  if (map.voxels.size() == 0)
    fail<BadInputException>(archive_path, ": has no voxel around the poses of ", path,
                            ": are they in its frame?");
  return map;
}

GeometrySamples
measure(const std::string& map_path, const std::string& sequence_folder,
        const Options& options)
{
  const KittiSequence sequence(sequence_folder);
  const MapFolder map = isArchive(map_path)
                            ? readAround(map_path, sequence, sequence_folder, options)
                            : readMapFolder(map_path);
  const Eigen::Isometry3d T_camera_velodyne =
      sequence.T_camera0_camera().inverse() * sequence.T_camera0_velodyne();
  MapGeometry geometry(map.voxels, options.parameters);
  ProgressBar progress("measuring", map.frames.size());
  for (const int frame : map.frames) {
    const auto scan =
        readVelodyneScan(sequence_folder + "/velodyne/" + frameFileName(frame, ".bin"));
    geometry.addScan(*scan, sequence.camera(),
                     map.T_world_camera0[std::size_t(frame)] *
                         sequence.T_camera0_camera(),
                     T_camera_velodyne);
    progress.step();
  }
  return geometry.samples();
}

GeometrySamples
measureClouds(const std::string& map_folder, const std::string& pattern,
              const Options& options)
{
  const MapFolder map = readMapFolder(map_folder);
  const CloudSequence clouds(pattern);
  const std::string sensor = readMapSummary(map_folder).sensor;
  if (sensor != "own" && sensor != "laser")
    fail<BadInputException>(map_folder, ": was not made of a scanner's clouds");
  refuseIf(sensor == "laser" && options.calibration.empty(),
           "clouds mapped with --sensor laser need its --calibration");
  const Eigen::Isometry3d T_camera0_scanner = scannerPose(sensor, options.calibration);
  std::map<int, std::size_t> positions;
  for (std::size_t i = 0; i < clouds.size(); ++i)
    positions[clouds.frameNumber(i)] = i;
  MapGeometry geometry(map.voxels, options.parameters);
  ProgressBar progress("measuring", map.frames.size());
  for (const int frame : map.frames) {
    const auto position = positions.find(frame);
    if (position == positions.end())
      fail<BadInputException>(pattern, ": has no cloud of frame ", frame,
                              ", which is in the map");
    geometry.addScan(readPositions(clouds.path(position->second)),
                     map.T_world_camera0[std::size_t(frame)] * T_camera0_scanner);
    progress.step();
  }
  return geometry.samples();
}

// Of the scans of frames that are not in the map, which the sequence has the poses of.
Reliability::Curve
judgeOccupancy(const std::string& map_folder, const std::string& sequence_folder,
               const std::string& archive_path)
{
  const MapArchive archive(archive_path, ArchiveAccess::read);
  const std::vector<int> mapped = readMapFolder(map_folder).frames;
  const KittiSequence sequence(sequence_folder);
  if (sequence.posesPath().empty())
    fail<BadInputException>(sequence_folder,
                            ": has no poses.txt, which --archive needs");
  const Trajectory poses = readKittiTrajectory(sequence.posesPath());
  OccupancyReliability reliability(archive, archive.header().parameters.voxel_size);
  int scans = 0;
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    const int frame = sequence.frameNumber(i);
    if (std::count(mapped.begin(), mapped.end(), frame) > 0)
      continue;
    if (std::size_t(frame) >= poses.size())
      fail<BadInputException>(sequence.posesPath(), ": has no pose of frame ", frame);
    reliability.addScan(
        readPositions(sequence_folder + "/velodyne/" + frameFileName(frame, ".bin")),
        worldFromFirstCamera() * poses[std::size_t(frame)] *
            sequence.T_camera0_velodyne());
    ++scans;
  }
  if (scans == 0)
    fail<BadInputException>(map_folder, ": all frames of ", sequence_folder,
                            " are in the map; map a part of them (--frames)");
  return reliability.curve();
}

int
evaluate(const Options& options)
{
  static_cast<void>(MapGeometry(VoxelCloud(), options.parameters)); // refuses bad bands
  GeometrySamples samples;
  for (std::size_t i = 0; i < options.maps.size(); ++i)
    samples += options.clouds.empty()
                   ? measure(options.maps[i], options.sequences[i], options)
                   : measureClouds(options.maps[i], options.clouds[i], options);
  Reliability::Curve occupancy(Reliability::kBins);
  for (std::size_t i = 0; i < options.archives.size(); ++i) {
    const Reliability::Curve more =
        judgeOccupancy(options.maps[i], options.sequences[i], options.archives[i]);
    for (std::size_t bin = 0; bin < more.size(); ++bin)
      occupancy[bin] += more[bin];
  }
  std::string json = geometryJson(samples, options.parameters);
  std::string table = geometryTable(samples, options.parameters);
  if (!options.archives.empty()) {
    auto all = nlohmann::ordered_json::parse(json);
    all["occupancy"] = nlohmann::ordered_json::parse(occupancyJson(occupancy));
    json = jsonText(all);
    table += occupancyTable(occupancy);
  }
  if (!options.output.empty())
    writeTextFile(options.output, json);
  if (options.header)
    std::cout << geometryMarkdownHeader(options.parameters);
  if (!options.row.empty())
    std::cout << geometryMarkdownRow(samples, options.parameters, options.row);
  if (!options.header && options.row.empty())
    printFigures(table, json);
  return exit_done;
}

} // namespace

int
main(int argc, char** argv)
{
  return run(usage.name, [&] { return evaluate(parse(argc, argv)); });
}
