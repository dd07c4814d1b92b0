// SPDX-License-Identifier: BSD-3-Clause
#include "map_arguments.h"
#include "parameter_options.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/pipeline/mapping_output.h>

#include <algorithm>
#include <filesystem>

namespace pcl_semantic::tool {

namespace {

// Options of the tool itself; those of MapperConfig come from its own list.
po::options_description
describeOptions(MapArguments& arguments)
{
  po::options_description options("Options");
  addSequenceOptions(arguments.sequence, options);
  options.add_options()(
      "clouds", po::value(&arguments.clouds),
      "clouds of any sensor, labelled or not, instead of SEQUENCE: folder or pattern "
      "of .pcd, .ply or KITTI's .bin, one per frame, in the sensor's frame; needs "
      "--poses FILE")("rgbd", po::value(&arguments.rgbd),
                      "RGB-D sequence instead of SEQUENCE: TUM's layout, or a folder "
                      "with rgb/ and depth/; "
                      "needs --calibration with the intrinsics (ROS camera_info, "
                      "Kalibr) and --poses FILE, "
                      "those of the camera in a world with z up")(
      "depth-scale",
      po::value(&arguments.depth_scale)->default_value(arguments.depth_scale),
      "number in its depth images that is a metre; 0 = 5000 in TUM's layout, else "
      "1000")("label-mapping", po::value(&arguments.label_mapping),
              tool::pixel_mapping_help)(
      "sensor", po::value(&arguments.sensor),
      "sensor of --clouds: own = any, --poses are its poses in a world with z up; or, "
      "with --calibration and poses of its camera 0: camera or grey = left camera of "
      "KITTI's colour or grey pair, laser = KITTI's Tr (default: own, or camera with "
      "--calibration)")("output", po::value(&arguments.output),
                        "output folder; replaces an earlier map in it")(
      "labels", po::value(&arguments.labels),
      "folder of stored label distributions, one .bin, .npy or .png per frame")(
      "label-set", po::value(&arguments.label_set),
      "label set of --labels (default: label_sets/kitti11.yaml)")(
      "network", po::value(&arguments.network), "network description (.yaml)")(
      "model", po::value(&arguments.model),
      "network (.onnx; default: as its description says)")(
      "label-calibration", po::value(&arguments.label_calibration),
      "calibration of the label distributions, see pcl_semantic_calibrate (.yaml)")(
      "clique-calibration", po::value(&arguments.clique_calibration),
      "calibration of the cliques, see pcl_semantic_calibrate --clique-config "
      "(.yaml)")(
      "poses", po::value(&arguments.poses)->default_value("auto"),
      "KITTI or TUM trajectory file; or sequence = its poses.txt, odometry = estimate "
      "them from the images, auto = poses.txt if there is one, else odometry")(
      "frames", po::value(&arguments.frames), "A:B = frames with numbers A <= n < B")(
      "also", po::value(&arguments.also),
      "further output for evaluation, separated by commas: measured = labels before "
      "the "
      "CRF, depth = depth images, scans = the class of each point of the sequence's "
      "laser scans")(
      "scan-within",
      po::value(&arguments.scan_within)->default_value(arguments.scan_within),
      "maximum distance of a scan point's voxel [m]; 0 = the voxel that contains it")(
      "archive", po::value(&arguments.archive.path),
      "archive file of the map; a killed run can be resumed from it")(
      "archive-every", po::value(&arguments.archive.every)->default_value(10),
      "commit to the archive every N frames")(
      "view", po::bool_switch(&arguments.view),
      "show the map in a window while it grows")(
      "resume", po::bool_switch(&arguments.archive.resume),
      "resume from the archive; start if there is none")(
      "config", po::value(&arguments.config),
      "parameter file (.yaml); options override it")(
      "print-config", po::bool_switch(&arguments.print_config),
      "print the effective parameters as YAML and exit");
  return options;
}

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

[[noreturn]] void
fail(const std::string& message)
{
  PCL_THROW_EXCEPTION(InvalidParameterException,
                      message << " (see pcl_semantic_map --help)");
}

void
requireLabels(const MapArguments& arguments)
{
  if (!arguments.sensor.empty())
    fail("--sensor is for --clouds");
  if (!arguments.label_mapping.empty() && arguments.labels.empty())
    fail("--label-mapping is for --labels or --clouds");
  if (arguments.labels.empty() == arguments.network.empty())
    fail("expected either --labels or --network");
  if (!arguments.model.empty() && arguments.network.empty())
    fail("--model needs --network");
  if (!arguments.label_set.empty() && arguments.labels.empty())
    fail("--label-set is for --labels; the description of a network names its own");
}

// Other sources of poses are those of stereo sequences.
void
requireTrajectory(const MapArguments& arguments, const std::string& option)
{
  if (arguments.poses == "auto" || arguments.poses == "sequence" ||
      arguments.poses == "odometry")
    fail(option + " needs a trajectory: --poses FILE");
}

void
requireClouds(const MapArguments& arguments)
{
  const SequenceOptions& sequence = arguments.sequence;
  const std::string& sensor = arguments.sensor;
  if (!sequence.folder.empty() || !sequence.files.left.empty() ||
      !sequence.files.right.empty() || sequence.strict)
    fail("--clouds and a SEQUENCE, --left, --right or --strict exclude each other");
  if (!arguments.labels.empty() || !arguments.network.empty() ||
      !arguments.model.empty())
    fail("--clouds bring their labels: pcl_semantic_label gives them some");
  requireTrajectory(arguments, "--clouds");
  if (sensor != "own" && sensor != "camera" && sensor != "grey" && sensor != "laser")
    fail("--sensor is '" + sensor + "', expected own, camera, grey or laser");
  if ((sensor == "own") != sequence.files.calibration.empty())
    fail(sensor == "own" ? "--calibration is not for --sensor own"
                         : "--sensor " + sensor + " needs --calibration");
  if (sequence.files.calibration.empty() && !sequence.files.extrinsics.empty())
    fail("--extrinsics needs --calibration");
}

void
requireRgbd(const MapArguments& arguments)
{
  const ImagePairFiles& files = arguments.sequence.files;
  if (!arguments.sequence.folder.empty() || !files.left.empty() ||
      !files.right.empty() || !files.extrinsics.empty() || !files.times.empty() ||
      arguments.sequence.strict || !arguments.clouds.empty())
    fail("--rgbd and a SEQUENCE, --clouds or options of pairs exclude each other");
  if (files.calibration.empty())
    fail("--rgbd needs --calibration, the camera's intrinsics");
  requireTrajectory(arguments, "--rgbd");
  if (!arguments.also.empty())
    fail("--also is for stereo");
  requireLabels(arguments);
}

} // namespace

bool
parseMapArguments(int argc, char** argv, MapArguments& arguments)
{
  po::options_description options = describeOptions(arguments);
  addParameters(parametersOf(arguments.parameters), options);
  po::variables_map values;
  const Usage usage{
      "pcl_semantic_map",
      "(SEQUENCE | --left 'L*.png' --right 'R*.png' --calibration FILE.yaml)\n"
      "  --output DIR (--labels DIR | --network FILE.yaml) [options]\n"
      "or --clouds DIR --poses FILE --output DIR [options]\n"
      "or --rgbd DIR --calibration FILE --poses FILE --output DIR\n"
      "  (--labels DIR | --network FILE.yaml) [options]",
      "Maps a stereo or RGB-D sequence, or labelled clouds of any sensor: writes a "
      "labelled "
      "voxel\n"
      "map, the classes as a camera sees them in it, pictures and a summary. Defaults "
      "of\n"
      "the parameters are shown.",
      "pcl_semantic_synthesize /tmp/street && \\\n"
      "  pcl_semantic_map /tmp/street --labels /tmp/street/labels --output /tmp/map"};
  po::positional_options_description positional;
  positional.add("sequence", 1);
  if (!parseCommandLine(argc, argv, usage, options, positional, values))
    return false;
  readMapperConfig(arguments.config, arguments.parameters);
  setParameters(values, parametersOf(arguments.parameters));
  arguments.parameters.validate();
  if (!arguments.clouds.empty() && arguments.sensor.empty())
    arguments.sensor = arguments.sequence.files.calibration.empty() ? "own" : "camera";
  return true;
}

void
requireMapArguments(const MapArguments& arguments)
{
  if (!(arguments.depth_scale >= 0.0))
    fail("--depth-scale is less than 0");
  if (!arguments.rgbd.empty())
    requireRgbd(arguments);
  else if (!arguments.clouds.empty())
    requireClouds(arguments);
  else {
    requireSequence(arguments.sequence, "pcl_semantic_map");
    requireLabels(arguments);
  }
  if (arguments.output.empty())
    fail("--output is missing");
  if (arguments.archive.resume && arguments.archive.path.empty())
    fail("--resume needs --archive");
  if (arguments.archive.every < 1)
    fail("--archive-every is less than 1");
  if (!arguments.archive.path.empty() &&
      isOutput(arguments.archive.path, arguments.output))
    fail("--archive is where --output puts its own files");
  if (!arguments.archive.path.empty() && arguments.poses == "odometry")
    fail("--archive needs poses from a file: odometry cannot go on where a run was "
         "killed; write them with pcl_semantic_odometry");
  for (const auto& [name, path] : inputsOf(arguments.sequence))
    if (name != "sequence" && isOutput(path, arguments.output))
      fail("--" + name + " is where --output puts its own files");
  std::error_code error;
  if (std::filesystem::is_directory(arguments.output, error) &&
      !listFrameFiles(arguments.output, {".png"}).empty())
    fail("--output holds images of frames; maps need a folder of their own");
  if (std::filesystem::exists(arguments.output + "/calib.txt", error))
    fail("--output holds a sequence (calib.txt); maps need a folder of their own");
  if (std::filesystem::equivalent(arguments.labels, arguments.output + "/labels",
                                  error))
    fail("--labels is where --output puts its own labels");
}

} // namespace pcl_semantic::tool
