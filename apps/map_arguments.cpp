// SPDX-License-Identifier: BSD-3-Clause
#include "map_arguments.h"
#include "cloud_doubts.h"
#include "opened_network.h"
#include "tool.h"
#include "unread_options.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/pipeline/mapping_output.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace pcl_semantic::tool {

namespace {

const Usage map_usage{
    "pcl_semantic_map",
    R"((SEQUENCE | --left 'L*.png' --right 'R*.png' --calibration FILE.yaml)
  --output DIR (--labels DIR | --network FILE.yaml) [options]
or --clouds DIR --poses FILE --output DIR [options]
or --rgbd DIR --calibration FILE --poses FILE --output DIR
  (--labels DIR | --network FILE.yaml) [options])",
    R"(Maps a stereo or RGB-D sequence, or labelled clouds of any sensor: writes a labelled voxel
map, the classes as a camera sees them in it, pictures and a summary. Defaults of
the parameters are shown.)",
    R"(pcl_semantic_synthesize /tmp/street && \
  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output /tmp/map)",
    {{"left GLOB, --right GLOB", "images of any stereo camera, instead of SEQUENCE"},
     {"calibration FILE", "of --left and --right: OpenCV, Kalibr, ROS, KITTI"},
     {"clouds GLOB", "clouds of any sensor, labelled or not, with --poses"},
     {"rgbd DIR", "RGB-D sequence, with --calibration and --poses"},
     {"labels DIR", "stored label distributions, a .bin, .npy or .png a frame"},
     {"network FILE", "network description (.yaml) instead of --labels"},
     {"poses FILE", "KITTI or TUM trajectory (default: poses.txt, else odometry)"},
     {"output DIR", "folder of the map, its pictures and its summary"},
     {"frames A:B", "frames with numbers A <= n < B"},
     {"voxel-size 0.1", "edge of a voxel [m]"},
     {"max-depth 40", "maximum depth of a hit [m]"},
     {"crf dense", "model: none, dense, pn-potts or hierarchical"},
     {"archive FILE", "archive of the map; --resume goes on from it"},
     {"view", "show the map in a window while it grows"},
     {"config FILE", "parameters (.yaml); --print-config writes them"}}};

const Usage live_usage{
    "pcl_semantic_live",
    R"((SEQUENCE | --left 0 --right 2 --calibration FILE.yaml)
  --output DIR (--labels DIR | --network FILE.yaml) [options])",
    R"(Maps what comes, until Ctrl-C; then the map is finished and written. SEQUENCE is a
folder that another program fills; --left and --right are cameras (0, /dev/video0),
streams (rtsp://...) or videos, or both the same camera, with its sides next to each
other. Takes the newest pair and drops those before it; labels are fused when they are
ready; no images of the frames are written.)",
    R"(pcl_semantic_synthesize /tmp/street && \
  timeout --preserve-status -s INT 10 \
    pcl_semantic_live /tmp/street --labels /tmp/street/labels --output /tmp/live_map)",
    {{"left NAME, --right NAME", "cameras, streams or videos, instead of SEQUENCE"},
     {"calibration FILE", "of --left and --right: OpenCV, Kalibr, ROS, KITTI"},
     {"every-frame", "map each pair of two videos"},
     {"labels DIR", "stored label distributions, a .bin, .npy or .png a frame"},
     {"network FILE", "network description (.yaml) instead of --labels"},
     {"poses FILE", "KITTI or TUM trajectory (default: odometry)"},
     {"output DIR", "folder of the map, its pictures and its summary"},
     {"voxel-size 0.1", "edge of a voxel [m]"},
     {"max-depth 40", "maximum depth of a hit [m]"},
     {"crf dense", "model: none, dense, pn-potts or hierarchical"},
     {"archive FILE", "archive of the map"},
     {"view", "show the map in a window while it grows"},
     {"config FILE", "parameters (.yaml); --print-config writes them"}}};

// Whether a file would be replaced or removed by what a run writes to its folder.
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

void
requireLabels(const MapArguments& arguments)
{
  refuseIf(!arguments.sensor.empty(), "--sensor is for --clouds");
  refuseIf(!arguments.label_mapping.empty() && arguments.labels.empty(),
           "--label-mapping is for --labels or --clouds");
  refuseIf(arguments.labels.empty() == arguments.network.empty(),
           "expected either --labels or --network");
  refuseIf(!arguments.model.empty() && arguments.network.empty(),
           "--model needs --network");
  requireEngine(arguments.engine, arguments.network);
  refuseIf(!arguments.label_set.empty() && arguments.labels.empty(),
           "--label-set is for --labels; the description of a network names its own");
}

// Other sources of poses are those of stereo sequences.
void
requireTrajectory(const MapArguments& arguments, const std::string& option)
{
  refuseIf(arguments.poses == "auto" || arguments.poses == "sequence" ||
               arguments.poses == "odometry",
           option + " needs a trajectory: --poses FILE" +
               (option == "--clouds" ? " or viewpoint" : ""));
}

void
requireClouds(const MapArguments& arguments)
{
  const SequenceOptions& sequence = arguments.sequence;
  const std::string& sensor = arguments.sensor;
  refuseIf(!sequence.folder.empty() || !sequence.files.left.empty() ||
               !sequence.files.right.empty() || sequence.strict,
           "--clouds and a SEQUENCE, --left, --right or --strict exclude each other");
  requireTrajectory(arguments, "--clouds");
  refuseIf(arguments.poses == "viewpoint" && sensor != "own",
           "--poses viewpoint is for --sensor own, whose own poses the clouds bring");
  refuseIf(arguments.poses == "viewpoint" && !arguments.submap_every.empty(),
           "--poses viewpoint and --submap-every exclude each other: submaps are cut "
           "before the clouds are read");
  refuseIf(sensor != "own" && sensor != "camera" && sensor != "grey" &&
               sensor != "laser",
           "--sensor is '" + sensor + "', expected own, camera, grey or laser");
  refuseIf((sensor == "own") != sequence.files.calibration.empty(),
           sensor == "own" ? "--calibration is not for --sensor own"
                           : "--sensor " + sensor + " needs --calibration");
  refuseIf(sequence.files.calibration.empty() && !sequence.files.extrinsics.empty(),
           "--extrinsics needs --calibration");
}

void
requireRgbd(const MapArguments& arguments)
{
  refuseIf(!arguments.sequence.folder.empty(),
           "--rgbd and a SEQUENCE exclude each other");
  refuseIf(arguments.sequence.files.calibration.empty(),
           "--rgbd needs --calibration, the camera's intrinsics");
  requireTrajectory(arguments, "--rgbd");
  requireLabels(arguments);
}

// Whether frames have images of their own, on which the map is drawn.
bool
hasCamera(const MapArguments& arguments)
{
  return arguments.clouds.empty() || arguments.sensor == "camera" ||
         arguments.sensor == "grey";
}

bool
asksFor(const MapArguments& arguments, const std::string& extra)
{
  const std::vector<std::string> words = splitAtCommas(arguments.also);
  return std::find(words.begin(), words.end(), extra) != words.end();
}

// What has no effect where frames come from, or without another option.
std::vector<UnreadOptions>
unreadOptions(const MapArguments& arguments)
{
  const std::vector<std::string> of_pairs = {"stereo", "disparities", "max-deviation",
                                             "deviation-scale"};
  const bool is_seen = hasCamera(arguments);
  std::vector<UnreadOptions> rules = {
      {!arguments.rgbd.empty(), "with --rgbd", of_pairs},
      {!arguments.rgbd.empty(),
       "with --rgbd",
       {"left", "right", "extrinsics", "times", "strict", "clouds", "also",
        "scan-within"}},
      {!arguments.clouds.empty(), "with --clouds", of_pairs},
      {!arguments.clouds.empty(),
       "with --clouds, which bring their labels (pcl_semantic_label gives them some)",
       {"labels", "network", "model", "engine", "network-every"}},
      {!is_seen,
       "with --clouds of no camera, which have no images",
       {"map-only", "min-hit-ratio", "label-calibration"}},
      {arguments.rgbd.empty(), "without --rgbd", {"depth-scale"}},
      {!arguments.network.empty(), "with --network", {"label-confidence"}},
      unreadOptionsOfLabels(arguments.labels),
      {arguments.archive.path.empty() && arguments.submap_every.empty(),
       "without --archive",
       {"archive-every"}},
      {!asksFor(arguments, "scans"), "without --also scans", {"scan-within"}},
      {arguments.clouds.empty() && !asksFor(arguments, "scans"),
       "without --clouds or --also scans",
       {"scan-columns"}}};
  const MapperConfig& config = arguments.parameters;
  for (UnreadOptions& rule : unreadOptionsOfCRF(config.crf, config.cliques))
    rules.push_back(std::move(rule));
  return rules;
}

void
requireLive(const MapArguments& arguments)
{
  refuseIf(!arguments.sequence.files.times.empty(), "--times needs --every-frame");
  refuseIf(arguments.parameters.network_every != 1,
           "--network-every is for maps of all frames");
  refuseIf(arguments.poses == "sequence",
           "--poses sequence: frames come without a file of poses");
}

// Of both programs.
std::vector<Option>
commonOptions(MapArguments& arguments)
{
  return {
      {"label-mapping", arguments.label_mapping, pixel_mapping_help},
      {"output", arguments.output,
       "output folder; replaces an earlier map in it, which stays in its folder "
       "`previous` until the new one is whole"},
      {"labels", arguments.labels,
       "folder of stored label distributions, one .bin, .npy or .png per frame"},
      {"label-set", arguments.label_set,
       "label set of --labels (default: label_sets/kitti11.yaml)"},
      {"network", arguments.network, "network description (.yaml)"},
      {"model", arguments.model, "network (.onnx; default: as its description says)"},
      {"engine", arguments.engine, engine_help},
      {"label-calibration", arguments.label_calibration,
       "calibration of the label distributions, see pcl_semantic_calibrate "
       "(.yaml)"},
      {"poses", withDefault(arguments.poses),
       "KITTI or TUM trajectory file; or sequence = its poses.txt, odometry = "
       "estimate them from the images, viewpoint = those in the VIEWPOINT of "
       "--clouds, auto = poses.txt if there is one, else odometry"},
      {"centres", arguments.centres,
       "give the points of map.pcd the centres of their voxels instead of the "
       "mean "
       "positions of the hits"},
      {"archive", arguments.archive.path,
       "archive file of the map; a killed run can be resumed from it"},
      {"archive-every", withDefault(arguments.archive.every),
       "commit to the archive every N frames"},
      {"view", arguments.view, "show the map in a window while it grows"},
      {"config", arguments.config, "parameter file (.yaml); options override it"},
      {"print-config", arguments.print_config,
       "print the effective parameters as YAML and exit"}};
}

// Where frames come from besides a sequence, and what needs all of them.
std::vector<Option>
mapOptions(MapArguments& arguments)
{
  return {{"clouds", arguments.clouds,
           "clouds of any sensor, labelled or not, instead of SEQUENCE: folder or "
           "pattern of .pcd, .ply or KITTI's .bin, one per frame, in the sensor's "
           "frame; needs --poses FILE"},
          {"rgbd", arguments.rgbd,
           "RGB-D sequence instead of SEQUENCE: TUM's layout, or a folder with rgb/ "
           "and depth/; needs --calibration with the intrinsics (ROS camera_info, "
           "Kalibr) and --poses FILE, those of the camera in a world with z up"},
          {"depth-scale", withDefault(arguments.depth_scale),
           "number in its depth images that is a metre; 0 = 5000 in TUM's layout, "
           "else 1000"},
          {"scan-columns", arguments.scan_columns, scan_columns_help},
          {"sensor", arguments.sensor,
           "sensor of --clouds: own = any, --poses are its poses in a world with z "
           "up; or, with --calibration and poses of its camera 0: camera or grey = "
           "left camera of KITTI's colour or grey pair, laser = KITTI's Tr (default: "
           "own, or camera with --calibration)"},
          {"clique-calibration", arguments.clique_calibration,
           "calibration of the cliques, see pcl_semantic_calibrate --clique-config "
           "(.yaml)"},
          {"map-only", arguments.map_only,
           "write the map, its trajectory and summary, but no images of the frames"},
          {"frames", arguments.frames, "A:B = frames with numbers A <= n < B"},
          {"also", arguments.also,
           "further output for evaluation, separated by commas: measured = labels "
           "before the CRF, depth = depth images, probabilities = those of the "
           "classes at the pixels' depths, scans = the class of each point of the "
           "sequence's laser scans, or of --clouds"},
          {"scan-within", withDefault(arguments.scan_within),
           "maximum distance of a scan point's voxel [m]; 0 = the voxel that contains "
           "it"},
          {"submap-every", arguments.submap_every,
           "cut the drive into submaps after so many metres (50m) or frames (100), "
           "each with an archive OUTPUT/FIRST.map and a folder OUTPUT/FIRST; "
           "pcl_semantic_archive merge joins them, also with corrected poses"},
          {"resume", arguments.archive.resume,
           "resume from the archive; start if there is none"}};
}

std::vector<Option>
liveOptions(MapArguments& arguments)
{
  return {{"every-frame", arguments.every_frame,
           "map each pair of two videos, as pcl_semantic_map maps a sequence"}};
}

po::variables_map
parseOptions(int argc, char** argv, MapProgram program, MapArguments& arguments)
{
  const bool is_live = program == MapProgram::live;
  std::vector<Option> options =
      is_live ? liveOptions(arguments) : mapOptions(arguments);
  for (Option& option : commonOptions(arguments))
    options.push_back(std::move(option));
  return parseCommandLine(argc, argv, is_live ? live_usage : map_usage,
                          withSequence(arguments.sequence, options), {"sequence"},
                          parametersOf(arguments.parameters));
}

} // namespace

MapArguments
parseMapArguments(int argc, char** argv, MapProgram program)
{
  refuseRemoved(argc, argv,
                {{"live", "the program pcl_semantic_live maps what comes"}});
  MapArguments arguments;
  const po::variables_map values = parseOptions(argc, argv, program, arguments);
  arguments.live = program == MapProgram::live && !arguments.every_frame;
  readMapperConfig(arguments.config, arguments.parameters);
  setParameters(values, parametersOf(arguments.parameters));
  arguments.parameters.validate();
  if (!arguments.clouds.empty() && arguments.sensor.empty())
    arguments.sensor = arguments.sequence.files.calibration.empty() ? "own" : "camera";
  arguments.states_confidence = values.count("label-confidence") > 0;
  if (!arguments.print_config)
    refuseUnread(values, unreadOptions(arguments));
  return arguments;
}

void
requireMapArguments(const MapArguments& arguments)
{
  refuseIf(!(arguments.depth_scale >= 0.0), "--depth-scale is less than 0");
  if (arguments.live)
    requireLive(arguments);
  refuseIf(arguments.poses == "viewpoint" && arguments.clouds.empty(),
           "--poses viewpoint is for --clouds");
  if (!arguments.rgbd.empty())
    requireRgbd(arguments);
  else if (!arguments.clouds.empty())
    requireClouds(arguments);
  else {
    requireSequence(arguments.sequence);
    requireLabels(arguments);
  }
  refuseIf(arguments.output.empty(), "--output is missing");
  refuseIf(arguments.archive.resume && arguments.archive.path.empty(),
           "--resume needs --archive");
  refuseIf(arguments.archive.every < 1, "--archive-every is less than 1");
  refuseIf(!arguments.archive.path.empty() &&
               isOutput(arguments.archive.path, arguments.output),
           "--archive is where --output puts its own files");
  refuseIf(!arguments.archive.path.empty() && arguments.poses == "odometry" &&
               !arguments.live,
           "--archive needs poses from a file: odometry cannot go on where a run was "
           "killed; write them with pcl_semantic_odometry");
  for (const auto& [name, path] : inputsOf(arguments.sequence))
    refuseIf(name != "sequence" && isOutput(path, arguments.output),
             "--" + name + " is where --output puts its own files");
  std::error_code error;
  refuseIf(std::filesystem::is_directory(arguments.output, error) &&
               !listFrameFiles(arguments.output, {".png"}).empty(),
           "--output holds images of frames; maps need a folder of their own");
  refuseIf(std::filesystem::exists(arguments.output + "/calib.txt", error),
           "--output holds a sequence (calib.txt); maps need a folder of their own");
  refuseIf(std::filesystem::equivalent(arguments.labels, arguments.output + "/labels",
                                       error),
           "--labels is where --output puts its own labels");
}

} // namespace pcl_semantic::tool
