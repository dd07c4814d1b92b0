// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/opened_inputs.h>

#include "core/fail.h"
#include "files/is_there.h"
#include "files/unread_options.h"

#include <pcl_semantic/core/camera_doubts.h>
#include <pcl_semantic/dataset/cloud_sequence.h>
#include <pcl_semantic/dataset/kitti_calibration.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/dataset/lidar_scan.h>
#include <pcl_semantic/dataset/rectifier.h>
#include <pcl_semantic/dataset/rgbd_sequence.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/labelling/stored_predictor.h>
#include <pcl_semantic/labelling/visible_points.h>
#include <pcl_semantic/odometry/stereo_odometry.h>
#include <pcl_semantic/odometry/trajectory_poses.h>
#include <pcl_semantic/pipeline/late_labels.h>

#include <boost/crc.hpp>

#include <map>
#include <utility>

namespace pcl_semantic {

namespace {

template <typename T>
void
append(std::vector<T>& values, const std::vector<T>& more)
{
  values.insert(values.end(), more.begin(), more.end());
}

// Opens the label set and the predictor of images: --network or --labels.
NamedValues
openLabels(const MapInputs& inputs, const MapperConfig& config,
           const InputOpeners& openers, OpenedInputs& opened)
{
  std::string model, engine;
  if (!inputs.network.empty()) {
    OpenedNetwork network =
        openers.network(inputs.network, inputs.model, inputs.engine);
    opened.label_set = network.label_set;
    opened.predictor = std::move(network.predictor);
    opened.labels_are_stored = false;
    model = network.model;
    engine = network.engine;
  }
  else if (inputs.labels.empty()) {
    opened.label_set = readLabelSetOrDefault("");
    opened.predictor = std::make_unique<NoLabels>();
    opened.has_labels = false;
    opened.doubts.push_back(
        "without --labels or --network the map has depth and colour, "
        "but no classes");
  }
  else {
    opened.label_set = readLabelSetOrDefault(inputs.label_set);
    PixelMapping mapping = readPixelMapping(inputs.label_mapping, opened.label_set);
    if (const auto* const numbers = std::get_if<LabelMapping>(&mapping))
      opened.mapping = *numbers;
    opened.mapping_name = inputs.label_mapping;
    opened.mapping_unit = "pixels";
    opened.predictor = std::make_unique<StoredPredictor>(
        inputs.labels, opened.label_set.size(), float(config.label_confidence),
        std::move(mapping));
  }
  return {{"labels", inputs.labels},
          {"label_mapping", inputs.label_mapping},
          {"network", inputs.network},
          {"model", model},
          {"engine", engine}};
}

// Returns the path of a trajectory, or "odometry".
// \param[in] path of the sequence's trajectory; empty = none
std::string
choosePoses(const MapInputs& inputs, const std::string& path)
{
  if (inputs.poses != "auto" && inputs.poses != "sequence")
    return inputs.poses;
  if (path.empty() && inputs.poses == "sequence")
    badInput(inputs.name(), ": has no ",
             inputs.rgbd.folder.empty() ? "poses.txt" : "groundtruth.txt or pose files",
             "; give a trajectory with --poses");
  return path.empty() ? "odometry" : path;
}

// Records a gap that was given, and refuses it without effect.
// \param[in] poses path of a trajectory, or odometry or viewpoint
void
addPoseGap(const MapInputs& inputs, const std::string& poses, OpenedInputs& opened)
{
  if (inputs.given.count("pose-gap") > 0 &&
      (poses == "odometry" || poses == "viewpoint" || isFolder(poses) ||
       trajectoryFormatOf(poses) == TrajectoryFormat::kitti))
    badParameter("--pose-gap has no effect without the times of a TUM trajectory");
  if (inputs.pose_gap == StoredPoses::default_gap)
    return;
  TextStream gap;
  gap << inputs.pose_gap;
  opened.values.emplace_back("pose_gap", gap.str());
}

// Reads the laser scans beside the images of a sequence.
ScanReader
openScans(const KittiSequence& kitti, const std::vector<FrameTime>& frames,
          const ScanColumns& columns)
{
  const std::string folder = kitti.folder() + "/velodyne/";
  const Eigen::Isometry3d T_camera_scanner =
      kitti.T_camera0_camera().inverse() * kitti.T_camera0_velodyne();
  for (const FrameTime& frame : frames) {
    const std::string scan = folder + frameFileName(frame.number, ".bin");
    if (!isThere(scan))
      badInput(scan, ": is missing; --also scans needs one per frame");
  }
  return [=](int frame) {
    return pointsInCamera(
        *readVelodyneScan(folder + frameFileName(frame, ".bin"), columns),
        T_camera_scanner);
  };
}

void
openStereo(const MapInputs& inputs, const MapperConfig& config,
           const InputOpeners& openers, OpenedInputs& opened)
{
  std::shared_ptr<FrameSequence> sequence =
      openSequence(inputs.sequence, opened.doubts, openers.videos);
  append(opened.doubts, doubtsOf(sequence->camera(), inputs.sequence.strict));
  const std::string poses = choosePoses(inputs, sequence->posesPath());
  const NamedValues labels = openLabels(inputs, config, openers, opened);
  opened.source =
      std::make_unique<RecordedFrames>(sequence, parseFrameRange(inputs.frames));
  opened.values = inputs.sequence.inputs();
  opened.values.emplace_back("poses", poses);
  addPoseGap(inputs, poses, opened);
  append(opened.values, labels);
  if (auto kitti = std::dynamic_pointer_cast<const KittiSequence>(sequence))
    opened.scans = [kitti, frames = opened.source->frames(),
                    columns = parseScanColumns(inputs.scan_columns)] {
      return openScans(*kitti, frames, columns);
    };
  openPoses(poses == "odometry" ? "" : poses, opened, inputs.pose_gap);
}

NamedValues
valuesOf(RgbdFiles files)
{
  NamedValues values;
  for (const ConfigParameter& each : parametersOf(files))
    values.emplace_back(each.name, each.text());
  return values;
}

void
openLive(const MapInputs& inputs, const MapperConfig& config,
         const InputOpeners& openers, OpenedInputs& opened)
{
  const NamedValues labels = openLabels(inputs, config, openers, opened);
  const std::string poses = inputs.poses == "auto" ? "odometry" : inputs.poses;
  const bool is_rgbd = !inputs.rgbd.folder.empty();
  std::optional<StoredTrajectory> trajectory;
  if (poses != "odometry") // checks it before waiting for the first frame
    trajectory =
        readTrajectory(poses, is_rgbd ? PoseFrame::camera : PoseFrame::first_camera);
  opened.source = openers.live(inputs);
  if (trajectory) {
    append(opened.doubts, trajectory->doubts);
    opened.poses =
        posesOf(*trajectory, opened.source->sensor().T_camera0_sensor, inputs.pose_gap);
  }
  else
    openPoses("", opened);
  opened.values = inputs.sequence.inputs();
  if (is_rgbd)
    append(opened.values, valuesOf(inputs.rgbd));
  append(opened.values, {{"live", "true"}, {"poses", poses}});
  addPoseGap(inputs, poses, opened);
  append(opened.values, labels);
}

// A file that changes is found by its digest; so are the files of single poses.
std::string
digestOf(const StoredTrajectory& trajectory)
{
  boost::crc_32_type crc;
  for (const TimedPose& timed : trajectory.poses)
    crc.process_bytes(timed.pose.data(), sizeof(double) * 16);
  return std::to_string(crc.checksum());
}

void
openRgbd(const MapInputs& inputs, const MapperConfig& config,
         const InputOpeners& openers, OpenedInputs& opened)
{
  const auto sequence =
      std::make_shared<RgbdSequence>(inputs.rgbd, inputs.sequence.files.calibration);
  const std::string poses = choosePoses(inputs, sequence->posesPath());
  std::optional<StoredTrajectory> of_frames; // before the frames are selected
  if (sequence->hasPoseFiles() && poses == sequence->posesPath())
    of_frames = sequence->takePoseFiles();
  const NamedValues labels = openLabels(inputs, config, openers, opened);
  append(opened.doubts, sequence->doubts());
  opened.source =
      std::make_unique<RecordedFrames>(sequence, parseFrameRange(inputs.frames));
  if (inputs.given.count("depth-within") > 0 && !sequence->isTum())
    badParameter("--depth-within has no effect on folders rgb and depth, whose names "
                 "match");
  if (sequence->isDistorted() && !inputs.labels.empty())
    opened.doubts.push_back(inputs.labels +
                            ": labels have to be of the undistorted images; "
                            "pcl_semantic_label --rgbd --calibration stores these");
  if (poses != "odometry" && !of_frames && !sequence->hasTimes() &&
      trajectoryFormatOf(poses) == TrajectoryFormat::tum)
    opened.doubts.push_back(inputs.rgbd.folder +
                            "/rgb: its images have no times and count as 0.1 s apart, "
                            "but " +
                            poses +
                            " has times: do they match? TUM's rgb.txt "
                            "gives the times of images");
  opened.values = inputs.sequence.inputs();
  append(opened.values, valuesOf(inputs.rgbd));
  opened.values.emplace_back("poses", poses);
  addPoseGap(inputs, poses, opened);
  append(opened.values, labels);
  if (!of_frames)
    return openPoses(poses == "odometry" ? "" : poses, opened, inputs.pose_gap);
  opened.values.emplace_back("pose_files", digestOf(*of_frames));
  append(opened.doubts, of_frames->doubts);
  opened.poses = posesOf(*of_frames);
}

// Reads a cloud whose labels do not matter.
LabelledCloud
readCloud(const std::string& path, const std::string& scan_columns)
{
  static const LabelMapping any_labels;
  return readLabelledCloud(path, &any_labels, parseScanColumns(scan_columns, path));
}

// Opens labelled clouds of a scanner or a camera.
class CloudOpener {
public:
  CloudOpener(const MapInputs& inputs, const MapperConfig& config, OpenedInputs& opened)
      : inputs_(inputs), confidence_(float(config.label_confidence)), opened_(opened),
        columns_(parseScanColumns(inputs.scan_columns)),
        clouds_(std::make_shared<const CloudSequence>(
            inputs.clouds, inputs.sequence.files.times, columns_))
  {}

  void
  open()
  {
    opened_.label_set = readLabelSetOrDefault(inputs_.label_set);
    const int classes = opened_.label_set.size();
    if (!inputs_.label_mapping.empty())
      opened_.mapping = readLabelMapping(inputs_.label_mapping, opened_.label_set);
    opened_.mapping_name = inputs_.label_mapping;
    opened_.mapping_unit = "points";
    positions_ = selectFrames(*clouds_, parseFrameRange(inputs_.frames));
    refuseOptionsOfLabels();
    opened_.source = std::make_unique<RecordedFrames>(
        sensor(), frameTimes(*clouds_, positions_),
        [clouds = clouds_, positions = positions_, classes, confidence = confidence_,
         mapping = opened_.mapping](std::size_t i) {
          return clouds->frame(positions[i], classes, confidence,
                               mapping ? &*mapping : nullptr);
        });
    opened_.values = inputs_.sequence.inputs();
    append(opened_.values, {{"clouds", inputs_.clouds},
                            {"label_mapping", inputs_.label_mapping},
                            {"sensor", inputs_.cloudSensor()},
                            {"poses", inputs_.poses}});
    if (!inputs_.scan_columns.empty())
      opened_.values.emplace_back("scan_columns", "[" + inputs_.scan_columns + "]");
    addPoseGap(inputs_, inputs_.poses, opened_);
    opened_.scans = [reader = scans()] { return reader; };
    openPoses();
  }

private:
  // Checks the first cloud with labels; the reader warns if others differ.
  void
  refuseOptionsOfLabels() const
  {
    const bool states_confidence = inputs_.given.count("label-confidence") > 0;
    if (!states_confidence && !opened_.mapping)
      return;
    for (const std::size_t position : positions_) {
      const std::string& path = clouds_->path(position);
      const LabelledCloud cloud = readCloud(path, inputs_.scan_columns);
      if (!cloud.has_labels || cloud.cloud->empty())
        continue;
      if (cloud.distributions.classes() > 0)
        badParameter(states_confidence ? "--label-confidence" : "--label-mapping",
                     " has no effect on the field 'probability' of ", path);
      return;
    }
  }

  // The pose of the sensor in camera 0, and its camera.
  FrameSensor
  sensor()
  {
    const std::string sensor = inputs_.cloudSensor();
    const ImagePairFiles& files = inputs_.sequence.files;
    if (sensor == "own") // looks along x in a world with z up
      return {std::nullopt, worldFromFirstCamera().inverse()};
    if (sensor == "laser") {
      const auto read = readKittiCalibration(files.calibration, KittiCameras::colour);
      if (!read.T_camera0_velodyne)
        badInput(files.calibration,
                 ": has no row 'Tr', expected the pose of the laser scanner");
      return {std::nullopt, *read.T_camera0_velodyne};
    }
    const RectifiedPair pair =
        readRectifiedPair({files.calibration, files.extrinsics}, firstCloud(),
                          sensor == "grey" ? KittiCameras::grey : KittiCameras::colour);
    append(opened_.doubts, pair.doubts);
    append(opened_.doubts, doubtsOf(pair.camera));
    return {pair.camera, pair.T_camera0_camera};
  }

  // First non-empty cloud: it has the size of the camera's images.
  SizedFile
  firstCloud() const
  {
    for (const std::size_t position : positions_) {
      const std::string& path = clouds_->path(position);
      const auto cloud = readCloud(path, inputs_.scan_columns).cloud;
      if (cloud->empty())
        continue;
      if (!cloud->isOrganized())
        badInput(path, ": is no organized cloud, expected one of the camera's image "
                       "size, or --sensor laser");
      return {{int(cloud->width), int(cloud->height)}, path};
    }
    badInput(inputs_.clouds, ": no cloud has a point");
  }

  // Uses the clouds as scans.
  ScanReader
  scans() const
  {
    std::map<int, std::string> paths;
    for (const std::size_t i : positions_)
      paths[clouds_->frameNumber(i)] = clouds_->path(i);
    return [paths, columns = inputs_.scan_columns](int frame) {
      LabelledCloud read = readCloud(paths.at(frame), columns);
      addOrigin(read);
      return pointsInCamera(*read.cloud, Eigen::Isometry3d::Identity());
    };
  }

  void
  openPoses()
  {
    if (inputs_.poses == "viewpoint")
      opened_.poses = std::make_unique<ViewpointPoses>();
    else if (inputs_.cloudSensor() == "own")
      opened_.poses = readSensorPoses(inputs_.poses, PoseFrame::sensor,
                                      inputs_.pose_gap, &opened_.doubts);
    else
      pcl_semantic::openPoses(inputs_.poses, opened_, inputs_.pose_gap);
  }

  const MapInputs& inputs_;
  float confidence_;
  OpenedInputs& opened_;
  ScanColumns columns_;
  std::shared_ptr<const CloudSequence> clouds_;
  std::vector<std::size_t> positions_; // of the frames in clouds_
};

} // namespace

void
openPoses(const std::string& trajectory, OpenedInputs& opened, double pose_gap)
{
  const FrameSensor& sensor = opened.source->sensor();
  opened.has_odometry = trajectory.empty();
  if (opened.has_odometry && sensor.has_depth)
    opened.poses = std::make_unique<StereoOdometry>(
        StereoOdometry::cameraOfDepths(*sensor.camera), sensor.T_camera0_sensor,
        StereoOdometry::parametersOfDepths());
  else if (opened.has_odometry)
    opened.poses =
        std::make_unique<StereoOdometry>(*sensor.camera, sensor.T_camera0_sensor);
  else if (sensor.has_depth)
    opened.poses =
        readSensorPoses(trajectory, PoseFrame::camera, pose_gap, &opened.doubts);
  else
    opened.poses =
        readPoses(trajectory, sensor.T_camera0_sensor, pose_gap, &opened.doubts);
}

OpenedInputs
openInputs(const MapInputs& inputs, const MapperConfig& config,
           const InputOpeners& openers)
{
  OpenedInputs opened;
  opened.name = inputs.name();
  if (openers.live)
    openLive(inputs, config, openers, opened);
  else if (!inputs.rgbd.folder.empty())
    openRgbd(inputs, config, openers, opened);
  else if (!inputs.clouds.empty())
    CloudOpener(inputs, config, opened).open();
  else
    openStereo(inputs, config, openers, opened);
  refuseUnread(inputs.given, {{!opened.label_set.hasThings(),
                               "with a label set without things",
                               {"things", "object-gap", "object-min-voxels"}}});
  if (!openers.live && opened.source->frames().empty())
    badInput(opened.name, ": has no frame in ", inputs.frames);
  if (!inputs.label_calibration.empty())
    opened.label_calibration =
        readCalibration(inputs.label_calibration, opened.label_set);
  append(opened.values, {{"label_calibration", inputs.label_calibration}});
  return opened;
}

} // namespace pcl_semantic
