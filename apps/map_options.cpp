// SPDX-License-Identifier: BSD-3-Clause
#include "map_options.h"
#include "tool.h"

#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/pipeline/mapping_output.h>
#include <pcl_semantic/pipeline/submap_cut.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <set>
#include <utility>

namespace pcl_semantic::tool {

namespace {

const Usage map_usage{
    "pcl_semantic_map",
    R"((SEQUENCE | --left 'L*.png' --right 'R*.png' --calibration FILE.yaml)
  --output DIR (--labels DIR | --network FILE.yaml) [options]
or --clouds DIR --poses FILE --output DIR [options]
or --rgbd DIR (--calibration FILE | --intrinsics FX,FY,CX,CY) --output DIR
  (--labels DIR | --network FILE.yaml) [options])",
    R"(Maps a stereo or RGB-D sequence, or labelled clouds of any sensor. Writes a labelled
voxel map, its classes rendered into the camera's images, pictures and a summary.)",
    R"(pcl_semantic_synthesize /tmp/street && \
  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output /tmp/map)",
    {{"left GLOB, --right GLOB", "images of any stereo camera, instead of SEQUENCE"},
     {"calibration FILE",
      "calibration of --left and --right: OpenCV, Kalibr, ROS, KITTI"},
     {"clouds GLOB", "clouds of any sensor, labelled or not, with --poses"},
     {"rgbd DIR", "RGB-D sequence, with --calibration or --intrinsics"},
     {"labels DIR", "stored label distributions, one .npy, .bin or .png per frame"},
     {"network FILE", "network description (.yaml) instead of --labels"},
     {"poses FILE", "KITTI or TUM trajectory (default: the sequence's, else odometry)"},
     {"output DIR", "folder of the map, its pictures and its summary"},
     {"frames A:B", "frames with numbers A <= n < B"},
     {"voxel-size 0.1", "edge of a voxel [m]"},
     {"max-depth 40", "maximum depth of a hit [m]"},
     {"crf dense", "CRF model: none, dense, pn-potts or hierarchical"},
     {"no-things", "do not follow objects, which then leave trails; find no planes"},
     {"archive FILE", "archive of the map; --resume continues from it"},
     {"view", "show the map in a window while it grows"},
     {"config FILE", "parameters (.yaml); --print-config writes them"}}};

const Usage live_usage{
    "pcl_semantic_live",
    R"((SEQUENCE | --left 0 --right 2 --calibration FILE.yaml
  | --rgbd DIR --intrinsics FX,FY,CX,CY)
  --output DIR (--labels DIR | --network FILE.yaml) [options])",
    R"(Maps live frames until Ctrl-C, then finishes and writes the map. SEQUENCE and
--rgbd are folders that another program fills. --left and --right are cameras (0,
/dev/video0), streams (rtsp://...) or videos; one camera with both images side by side
is given as both. Maps the newest pair and drops earlier ones. Labels are fused when
they are ready. No images of the frames are written.)",
    R"(pcl_semantic_synthesize /tmp/street && \
  timeout --preserve-status -s INT 10 \
    pcl_semantic_live /tmp/street --labels /tmp/street/labels --output /tmp/live_map)",
    {{"left NAME, --right NAME", "cameras, streams or videos, instead of SEQUENCE"},
     {"rgbd DIR", "folder with rgb/ and depth/, with --calibration or --intrinsics"},
     {"calibration FILE",
      "calibration of --left and --right: OpenCV, Kalibr, ROS, KITTI"},
     {"every-frame", "map each pair of two videos"},
     {"labels DIR", "stored label distributions, one .npy, .bin or .png per frame"},
     {"network FILE", "network description (.yaml) instead of --labels"},
     {"poses FILE", "KITTI or TUM trajectory (default: odometry)"},
     {"output DIR", "folder of the map, its pictures and its summary"},
     {"voxel-size 0.1", "edge of a voxel [m]"},
     {"max-depth 40", "maximum depth of a hit [m]"},
     {"crf dense", "CRF model: none, dense, pn-potts or hierarchical"},
     {"no-things", "do not follow objects, which then leave trails; find no planes"},
     {"archive FILE", "archive of the map"},
     {"view", "show the map in a window while it grows"},
     {"config FILE", "parameters (.yaml); --print-config writes them"}}};

// Whether a run would replace or remove a file in its output folder.
bool
isOutput(const std::string& file, const std::string& folder)
{
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path relative =
      fs::weakly_canonical(fs::absolute(file, error), error)
          .lexically_relative(fs::weakly_canonical(fs::absolute(folder, error), error));
  const std::vector<std::string>& names = MappingOutput::names();
  return !relative.empty() &&
         std::find(names.begin(), names.end(), *relative.begin()) != names.end();
}

// The inputs of a program; live frames are of a stereo or RGB-D camera.
ConfigParameters
inputsOf(MapInputs& inputs, MapProgram program)
{
  static const std::set<std::string> of_recordings = {
      "clouds", "depth_within", "scan_columns", "sensor", "frames"};
  static const std::map<std::string, std::string> live_help = {
      {"sequence", "folder in KITTI's odometry layout that another program fills"},
      {"left", "left camera (0, /dev/video0), stream (rtsp://...) or video, instead of "
               "SEQUENCE"},
      {"rgbd", "folder with rgb/ and depth/ that another program fills, instead of "
               "SEQUENCE; needs --calibration or --intrinsics"},
      {"calibration",
       "calibration of --left and --right, or the camera of --rgbd: OpenCV, "
       "Kalibr, ROS, EuRoC (.yaml), KITTI or Middlebury (.txt)"},
      {"depth_scale", "value of 1 m in the depth images of --rgbd; 0 = 1000"},
      {"right", "right camera, stream or video; the same name as --left if each image "
                "holds both sides"},
      {"times", "time stamps of the images with --every-frame, one per line [s] "
                "(default: rate of the videos)"},
      {"poses", "trajectory file (KITTI or TUM), or odometry = estimated from the "
                "images; auto = odometry"}};
  ConfigParameters parameters = parametersOf(inputs);
  if (program != MapProgram::live)
    return parameters;
  parameters.erase(std::remove_if(parameters.begin(), parameters.end(),
                                  [](const ConfigParameter& each) {
                                    return of_recordings.count(each.name) > 0;
                                  }),
                   parameters.end());
  for (ConfigParameter& each : parameters)
    if (const auto found = live_help.find(each.name); found != live_help.end())
      each.help = found->second;
  return parameters;
}

// --things and --no-things.
struct ThingOptions {
  bool required = false, none = false;
};

std::vector<Option>
outputsOf(MapOptions& options, ThingOptions& things, MapProgram program)
{
  MapOutputs& outputs = options.outputs;
  std::vector<Option> all = {
      {"output", outputs.folder,
       "output folder; an earlier map in it is kept in its folder `previous` until the "
       "new map is complete"},
      {"centres", outputs.centres,
       "write the points of map.pcd at the centres of their voxels instead of the mean "
       "positions of the hits"},
      {"archive", outputs.archive.path,
       program == MapProgram::live
           ? "archive file of the map"
           : "archive file of the map; --resume continues a killed run from it"},
      {"archive-every", withDefault(outputs.archive.every),
       "commit to the archive every N frames"},
      {"things", things.required,
       "fail unless the label set marks classes as thing: their objects are numbered "
       "and followed over the frames, see objects.json and boxes.ply"},
      {"no-things", things.none,
       "do not follow objects, which leave a trail if they move, and write no planes"},
      {"view", options.view, "show the map in a window while it grows"}};
  if (program == MapProgram::live) {
    all.emplace_back("every-frame", options.every_frame,
                     "map each pair of two videos, as pcl_semantic_map maps a "
                     "sequence");
    return all;
  }
  const std::vector<Option> more = {
      {"map-only", po::bool_switch(),
       "write the map, its trajectory and summary, but no images of the frames"},
      {"also", outputs.also,
       "additional outputs for evaluation, separated by commas: measured = labels "
       "before the CRF, depth = depth images and the labels of the finished map at "
       "these depths, probabilities = class probabilities at the depth of each pixel, "
       "scans = class of each point in the laser scans or in "
       "--clouds"},
      {"scan-within", withDefault(outputs.scan_within),
       "maximum distance from a scan point to the voxel that gives its class [m]; 0 = "
       "the voxel that contains it"},
      {"submap-every", options.submap_every,
       "length of a submap in metres (50m) or frames (100); each has an archive "
       "OUTPUT/FIRST.map and a folder OUTPUT/FIRST, named after its first frame; "
       "pcl_semantic_archive merge joins submaps, also with corrected poses"},
      {"resume", outputs.archive.resume,
       "resume from the archive, or start a new one if there is none"}};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

void
requireLive(const MapOptions& options)
{
  refuseIf(!options.inputs.sequence.files.times.empty(), "--times needs --every-frame");
  refuseIf(options.config.network_every != 1, "--network-every needs --every-frame");
  refuseIf(options.inputs.poses == "sequence",
           "--poses sequence is for recorded sequences: live frames have no poses.txt");
}

void
requireArchive(const MapOptions& options)
{
  const MappingArchive::Options& archive = options.outputs.archive;
  refuseIf(archive.resume && archive.path.empty() && options.submap_every.empty(),
           "--resume needs --archive");
  refuseIf(archive.every < 1, "--archive-every is less than 1");
  refuseIf(!archive.path.empty() && isOutput(archive.path, options.outputs.folder),
           "--archive is a path that --output writes; choose another path");
  if (options.submap_every.empty())
    return;
  asUsage([&] { parseSubmapLength(options.submap_every, options.inputs); });
  refuseIf(!archive.path.empty() || options.view,
           "--submap-every and --archive or --view exclude each other");
}

void
requireOutput(const MapOptions& options)
{
  const MapInputs& inputs = options.inputs;
  const std::string& output = options.outputs.folder;
  refuseIf(output.empty(), "--output is missing");
  for (const auto& [name, path] : inputs.sequence.inputs())
    refuseIf(name != "sequence" && isOutput(path, output),
             "--" + name + " is a path that --output writes; choose another --output");
  std::error_code error;
  const auto isSame = [&](const std::string& input, const std::string& written) {
    return std::filesystem::equivalent(input, output + written, error);
  };
  refuseIf(std::filesystem::is_directory(output, error) &&
               !listFrameFiles(output, {".png"}).empty(),
           "--output holds images of frames; maps need a folder of their own");
  refuseIf(std::filesystem::exists(output + "/calib.txt", error),
           "--output holds a sequence (calib.txt); maps need a folder of their own");
  refuseIf(
      isSame(inputs.labels, "/labels"),
      "--labels is the folder of labels that --output writes; choose another --output");
  refuseIf(!inputs.clouds.empty() && isSame(inputs.poses, "/trajectory.txt"),
           "--poses is the trajectory that --output writes; choose another --output");
  refuseIf(!inputs.clouds.empty() && isSame(inputs.clouds, ""),
           "--output holds the clouds; maps need a folder of their own");
}

} // namespace

MapOptions
parseMapOptions(int argc, char** argv, MapProgram program)
{
  refuseRemoved(argc, argv,
                {{"live", "the program pcl_semantic_live maps what comes"}});
  MapOptions options;
  std::string config;
  bool print_config = false;
  ThingOptions things;
  std::vector<Option> all = optionsOf(inputsOf(options.inputs, program));
  for (Option& option : outputsOf(options, things, program))
    all.push_back(std::move(option));
  all.emplace_back("config", config, "parameter file (.yaml); options override it");
  all.emplace_back("print-config", print_config,
                   "print the effective parameters as YAML and exit");
  const bool is_map = program == MapProgram::map;
  const po::variables_map values =
      parseCommandLine(argc, argv, is_map ? map_usage : live_usage, all, {"sequence"},
                       parametersOf(options.config));
  readMapperConfig(config, options.config);
  setParameters(values, parametersOf(options.config));
  refuseIf(things.required && things.none,
           "--things and --no-things exclude each other");
  if (things.required || things.none)
    options.config.things = things.required;
  options.config.validate();
  if (print_config) {
    std::cout << printMapperConfig(options.config);
    throw Exit{exit_done};
  }
  options.inputs.given = givenOptions(values);
  const bool is_live = !is_map && !options.every_frame;
  options.outputs.images = is_map ? !values["map-only"].as<bool>() : !is_live;
  const std::vector<std::string> also = splitAtCommas(options.outputs.also);
  options.inputs.reads_scans = std::count(also.begin(), also.end(), "scans") > 0;
  refuseUnread(
      values, {{options.outputs.archive.path.empty() && options.submap_every.empty(),
                "without --archive",
                {"archive-every"}},
               {!options.inputs.reads_scans, "without --also scans", {"scan-within"}}});
  if (is_live)
    requireLive(options);
  asUsage([&] { options.inputs.validate(options.config); });
  requireArchive(options);
  requireOutput(options);
  return options;
}

} // namespace pcl_semantic::tool
