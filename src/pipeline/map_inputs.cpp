// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/map_inputs.h>

#include "core/fail.h"
#include "files/unread_options.h"

#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/labelling/opened_network.h>

#include <utility>

namespace pcl_semantic {

namespace {

void
refuseIf(bool condition, const std::string& message)
{
  if (condition)
    badParameter(message);
}

void
requireLabels(const MapInputs& inputs)
{
  refuseIf(!inputs.sensor.empty(), "--sensor is for --clouds");
  refuseIf(!inputs.label_mapping.empty() && inputs.labels.empty(),
           "--label-mapping is for --labels or --clouds");
  refuseIf(!inputs.labels.empty() && !inputs.network.empty(),
           "--labels and --network exclude each other");
  refuseIf(!inputs.model.empty() && inputs.network.empty(), "--model needs --network");
  requireEngine(inputs.engine, inputs.network);
  refuseIf(!inputs.label_set.empty() && inputs.labels.empty(),
           "--label-set is for --labels; the description of a network names its own");
}

void
requireClouds(const MapInputs& inputs)
{
  const SequenceFiles& sequence = inputs.sequence;
  const std::string sensor = inputs.cloudSensor();
  refuseIf(!sequence.folder.empty() || !sequence.files.left.empty() ||
               !sequence.files.right.empty() || sequence.strict,
           "--clouds and a SEQUENCE, --left, --right or --strict exclude each other");
  refuseIf(inputs.poses == "auto" || inputs.poses == "sequence" ||
               inputs.poses == "odometry",
           "--clouds needs a trajectory: --poses FILE or viewpoint");
  refuseIf(
      inputs.poses == "viewpoint" && sensor != "own",
      "--poses viewpoint is for --sensor own: a VIEWPOINT is the pose of the sensor");
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
requireRgbd(const MapInputs& inputs)
{
  refuseIf(!inputs.sequence.folder.empty(), "--rgbd and a SEQUENCE exclude each other");
  inputs.rgbd.requireCamera(inputs.sequence.files.calibration);
  requireLabels(inputs);
}

// Rules for options that have no effect with these inputs.
std::vector<UnreadOptions>
unreadOptions(const MapInputs& inputs, const MapperConfig& config)
{
  const std::vector<std::string> of_pairs = {"stereo", "disparities", "max-deviation",
                                             "deviation-scale"};
  const bool is_rgbd = !inputs.rgbd.folder.empty();
  std::vector<UnreadOptions> rules = {
      {is_rgbd, "with --rgbd", of_pairs},
      {is_rgbd,
       "with --rgbd",
       {"left", "right", "extrinsics", "times", "strict", "clouds", "scan-within"}},
      {!inputs.clouds.empty(), "with --clouds", of_pairs},
      {!inputs.clouds.empty(),
       "with --clouds, which hold their labels (pcl_semantic_label adds labels to "
       "clouds)",
       {"labels", "network", "model", "engine", "network-every"}},
      {!inputs.hasCamera(),
       "with --clouds that are not of a camera",
       {"map-only", "min-hit-ratio", "label-calibration"}},
      {!is_rgbd, "without --rgbd", {"depth-scale", "depth-within", "intrinsics"}},
      {inputs.clouds.empty() && !inputs.hasImageLabels(),
       "without --labels or --network",
       {"crf", "network-every", "label-calibration"}},
      {inputs.clouds.empty() && !inputs.reads_scans,
       "without --clouds or --also scans",
       {"scan-columns"}},
      {!inputs.network.empty(), "with --network", {"label-confidence"}},
      {!config.things, "without things", {"object-gap", "object-min-voxels"}},
      unreadOptionsOfLabels(inputs.labels)};
  for (UnreadOptions& rule : unreadOptionsOfCRF(nameOf(config.crf), config.cliques))
    rules.push_back(std::move(rule));
  return rules;
}

} // namespace

std::string
MapInputs::cloudSensor() const
{
  if (clouds.empty() || !sensor.empty())
    return sensor;
  return sequence.files.calibration.empty() ? "own" : "camera";
}

bool
MapInputs::hasImageLabels() const
{
  return !labels.empty() || !network.empty();
}

bool
MapInputs::hasCamera() const
{
  const std::string of_clouds = cloudSensor();
  return clouds.empty() || of_clouds == "camera" || of_clouds == "grey";
}

const std::string&
MapInputs::name() const
{
  return !rgbd.folder.empty() ? rgbd.folder
         : !clouds.empty()    ? clouds
                              : sequence.name();
}

void
MapInputs::validate(const MapperConfig& config) const
{
  refuseUnread(given, unreadOptions(*this, config));
  refuseIf(!(rgbd.depth_scale >= 0.0), "--depth-scale is less than 0");
  refuseIf(!(rgbd.depth_within >= 0.0), "--depth-within is less than 0");
  refuseIf(!(pose_gap >= 0.0), "--pose-gap is less than 0");
  refuseIf(poses == "viewpoint" && clouds.empty(), "--poses viewpoint is for --clouds");
  parseFrameRange(frames);
  if (!rgbd.folder.empty())
    return requireRgbd(*this);
  if (!clouds.empty())
    return requireClouds(*this);
  sequence.validate();
  requireLabels(*this);
}

ConfigParameters
parametersOf(MapInputs& inputs)
{
  ConfigParameters parameters = parametersOf(inputs.sequence);
  const ConfigParameters of_rgbd = parametersOf(inputs.rgbd);
  parameters.insert(parameters.end(), of_rgbd.begin(), of_rgbd.end());
  const ConfigParameters more = {
      {"clouds",
       "clouds of any sensor, labelled or not, instead of SEQUENCE: folder or pattern "
       "of .pcd, .ply or KITTI .bin files, one per frame, in the sensor frame; needs "
       "--poses FILE or viewpoint",
       &inputs.clouds},
      {"scan_columns", kScanColumnsHelp, &inputs.scan_columns},
      {"sensor",
       "sensor of --clouds: own = any sensor, --poses has its poses in a world with z "
       "up; with --calibration, --poses has the poses of camera 0: camera = left "
       "camera of KITTI's colour pair, grey = left camera of KITTI's grey pair, laser "
       "= laser scanner at KITTI's Tr (default: own; with --calibration camera)",
       &inputs.sensor},
      {"labels",
       "folder of stored label distributions, one .bin, .npy, .npy.zst or .png per "
       "frame",
       &inputs.labels},
      {"label_set", "label set of --labels (default: label_sets/kitti11.yaml)",
       &inputs.label_set},
      {"label_mapping", kPixelMappingHelp, &inputs.label_mapping},
      {"network", "network description (.yaml)", &inputs.network},
      {"model", "network (.onnx; default: the file that its description names)",
       &inputs.model},
      {"engine", kEngineHelp, &inputs.engine},
      {"label_calibration",
       "calibration of the label distributions, see doc/calibration.md (.yaml)",
       &inputs.label_calibration},
      {"poses",
       "trajectory file (KITTI or TUM) or a source of poses: sequence = poses.txt of "
       "SEQUENCE or groundtruth.txt of --rgbd, odometry = estimated from the images, "
       "viewpoint = VIEWPOINT of --clouds, auto = those of the sequence if there are "
       "any, else odometry; a file has the poses of camera 0, with --rgbd and --clouds "
       "those of the sensor in a world with z up",
       &inputs.poses},
      {"pose_gap",
       "maximum gap between two poses of a TUM trajectory that are interpolated [s]; 0 "
       "= take the nearest within 0.01 s",
       &inputs.pose_gap},
      {"frames", "A:B = frames with numbers A <= n < B; : = all", &inputs.frames}};
  parameters.insert(parameters.end(), more.begin(), more.end());
  return parameters;
}

} // namespace pcl_semantic
