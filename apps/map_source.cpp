// SPDX-License-Identifier: BSD-3-Clause
#include "map_source.h"

#include "default_label_set.h"
#include "messages.h"
#include "pair_watch.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/frame_range.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/dataset/rectifier.h>
#include <pcl_semantic/dataset/rgbd_sequence.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/labelling/network_predictor.h>
#include <pcl_semantic/labelling/stored_predictor.h>
#include <pcl_semantic/odometry/trajectory_poses.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

#include <filesystem>
#include <sstream>

namespace pcl_semantic::tool {

namespace {

void
addScans(const MapArguments& arguments, const FrameSequence* sequence,
         const std::vector<std::size_t>& frames, ExtraOptions& extra)
{
  const auto* const kitti = dynamic_cast<const KittiSequence*>(sequence);
  if (!kitti)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "--also scans needs a SEQUENCE with laser scans (velodyne)");
  extra.scans = kitti->folder() + "/velodyne";
  extra.T_camera_scanner =
      kitti->T_camera0_camera().inverse() * kitti->T_camera0_velodyne();
  for (const std::size_t i : frames) {
    const std::string scan =
        extra.scans + "/" + frameFileName(kitti->frameNumber(i), ".bin");
    if (!std::filesystem::exists(scan))
      PCL_THROW_EXCEPTION(BadInputException,
                          scan << ": is missing; --also scans needs one a frame");
  }
  extra.within = arguments.scan_within;
}

} // namespace

ExtraOptions
makeExtras(const MapArguments& arguments, const FrameSequence* sequence,
           const std::vector<std::size_t>& frames)
{
  if (!(arguments.scan_within >= 0.0 && arguments.scan_within <= 2.0))
    PCL_THROW_EXCEPTION(InvalidParameterException, "--scan-within is "
                                                       << arguments.scan_within
                                                       << ", expected 0 to 2");
  ExtraOptions extra;
  std::istringstream words(arguments.also);
  for (std::string word; std::getline(words, word, ',');)
    if (word == "measured")
      extra.measured = true;
    else if (word == "depth")
      extra.depth = true;
    else if (word == "scans")
      addScans(arguments, sequence, frames, extra);
    else
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "--also: '" << word
                                      << "', expected measured, depth or scans");
  return extra;
}

Labelling
makeLabelling(const MapArguments& arguments)
{
  if (!arguments.network.empty()) {
    const NetworkDescription network = readNetworkDescription(arguments.network);
    const LabelSet label_set = readLabelSet(network.label_set_path);
    return {label_set,
            std::make_unique<NetworkPredictor>(network, label_set, arguments.model),
            arguments.model.empty() ? network.model_path : arguments.model};
  }
  const LabelSet label_set = readLabelSetOrDefault(arguments.label_set);
  return {label_set,
          std::make_unique<StoredPredictor>(
              arguments.labels, label_set.size(),
              float(arguments.parameters.label_confidence),
              readPixelMapping(arguments.label_mapping, label_set)),
          ""};
}

Calibrations
readCalibrations(const MapArguments& arguments, const LabelSet& label_set)
{
  Calibrations calibrations;
  if (!arguments.label_calibration.empty())
    calibrations.labels = readCalibration(arguments.label_calibration, label_set);
  if (!arguments.clique_calibration.empty())
    calibrations.cliques =
        readCalibration(arguments.clique_calibration, label_set, "cliques");
  return calibrations;
}

void
setCalibrations(const Calibrations& calibrations, SemanticMapper& mapper)
{
  if (calibrations.labels)
    mapper.setLabelCalibration(*calibrations.labels);
  if (calibrations.cliques)
    mapper.setCliqueCalibration(*calibrations.cliques);
}

std::string
choosePoses(const MapArguments& arguments, const FrameSequence& sequence)
{
  if (arguments.poses != "auto" && arguments.poses != "sequence")
    return arguments.poses;
  const std::string path = sequence.posesPath();
  if (!path.empty())
    return path;
  if (arguments.poses == "sequence")
    PCL_THROW_EXCEPTION(BadInputException,
                        arguments.sequence.name()
                            << ": has no poses.txt; give a trajectory with --poses");
  if (!arguments.archive.path.empty())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "--archive needs poses from a file, but "
                            << arguments.sequence.name()
                            << " has no poses.txt; write them with "
                               "pcl_semantic_odometry and give them with --poses");
  return "odometry";
}

std::unique_ptr<PoseSource>
makePoses(const std::string& chosen, const FrameSequence& sequence)
{
  const Eigen::Isometry3d& T_camera0_camera = sequence.T_camera0_camera();
  if (chosen == "odometry")
    return std::make_unique<StereoOdometry>(sequence.camera(), T_camera0_camera);
  return readPoses(chosen, T_camera0_camera);
}

namespace {

// What a source is made from whose images are labelled in the run.
void
addLabelledInputs(const MapArguments& arguments, const std::string& poses,
                  const std::string& model, MappingRun& run)
{
  run.inputs.insert(run.inputs.end(),
                    {{"poses", poses},
                     {"labels", arguments.labels},
                     {"label_mapping", arguments.label_mapping},
                     {"network", arguments.network},
                     {"model", model},
                     {"label_calibration", arguments.label_calibration},
                     {"clique_calibration", arguments.clique_calibration}});
}

class SequenceSource : public MapSource {
public:
  explicit SequenceSource(const MapArguments& arguments)
      : sequence_(openSequence(arguments.sequence)),
        watch_(arguments.sequence.strict, sequence_->camera())
  {
    poses_ = choosePoses(arguments, *sequence_);
    Labelling labelling = makeLabelling(arguments);
    positions_ = chooseFrames(arguments.sequence, *sequence_, arguments.frames);
    run_.inputs = inputsOf(arguments.sequence);
    addLabelledInputs(arguments, poses_, labelling.model, run_);
    for (const std::size_t i : positions_)
      run_.frames.push_back(sequence_->frameNumber(i));
    labelling.predictor->requireFrames(run_.frames);
    run_.camera = sequence_->camera();
    run_.T_camera0_camera = sequence_->T_camera0_camera();
    run_.label_set = labelling.label_set;
    predictor_ = std::move(labelling.predictor);
    run_.config = arguments.parameters;
    extras_ = makeExtras(arguments, sequence_.get(), positions_);
    calibrations_ = readCalibrations(arguments, run_.label_set);
  }

  std::vector<FrameTime>
  times() const override
  {
    return frameTimes(*sequence_, positions_);
  }

  std::unique_ptr<PoseSource>
  openPoses() const override
  {
    return makePoses(poses_, *sequence_);
  }

  std::optional<SensorFrame>
  next() override
  {
    if (next_ >= positions_.size())
      return std::nullopt;
    const StereoFrame pair = sequence_->frame(positions_[next_++]);
    watch_.look(pair);
    return pair;
  }

private:
  std::unique_ptr<FrameSequence> sequence_;
  PairWatch watch_;
  std::vector<std::size_t> positions_;
};

} // namespace

std::unique_ptr<SemanticMapper>
MapSource::makeMapper(std::unique_ptr<PoseSource> poses,
                      std::shared_ptr<BlockStore> store)
{
  auto mapper = std::make_unique<SemanticMapper>(
      run_.label_set, run_.config, std::move(poses), run_.camera, std::move(predictor_),
      std::move(store));
  setCalibrations(calibrations_, *mapper);
  return mapper;
}

std::unique_ptr<MapSource>
openMapSource(const MapArguments& arguments)
{
  if (!arguments.rgbd.empty())
    return openRgbdSource(arguments);
  if (!arguments.clouds.empty())
    return openCloudSource(arguments);
  return std::make_unique<SequenceSource>(arguments);
}

namespace {

class CloudSource : public MapSource {
public:
  explicit CloudSource(const MapArguments& arguments)
      : arguments_(arguments), clouds_(arguments.clouds, arguments.sequence.files.times)
  {
    std::error_code error;
    if (std::filesystem::equivalent(arguments.poses,
                                    arguments.output + "/trajectory.txt", error))
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "--poses is where --output puts its own trajectory");
    if (std::filesystem::equivalent(arguments.clouds, arguments.output, error))
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "--output holds the clouds; maps need a folder of their own");
    poses_ = arguments.poses;
    run_.label_set = readLabelSetOrDefault(arguments.label_set);
    run_.config = arguments.parameters;
    if (!arguments.label_mapping.empty())
      mapping_ = readLabelMapping(arguments.label_mapping, run_.label_set);
    positions_ = chooseClouds(arguments.clouds, clouds_, arguments.frames);
    for (const std::size_t i : positions_)
      run_.frames.push_back(clouds_.frameNumber(i));
    setSensor();
    if (!run_.camera && !arguments.also.empty())
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "--also is for frames of a camera");
    run_.inputs = inputsOf(arguments.sequence);
    run_.inputs.insert(run_.inputs.end(),
                       {{"clouds", arguments.clouds},
                        {"label_mapping", arguments.label_mapping},
                        {"sensor", arguments.sensor},
                        {"poses", poses_},
                        {"label_calibration", arguments.label_calibration},
                        {"clique_calibration", arguments.clique_calibration}});
    calibrations_ = readCalibrations(arguments, run_.label_set);
    extras_ = makeExtras(arguments, nullptr, positions_);
  }

  std::vector<FrameTime>
  times() const override
  {
    std::vector<FrameTime> times;
    for (const std::size_t i : positions_)
      times.push_back({clouds_.frameNumber(i), clouds_.timestamp(i)});
    return times;
  }

  std::unique_ptr<PoseSource>
  openPoses() const override
  {
    return arguments_.sensor == "own" ? readSensorPoses(poses_)
                                      : readPoses(poses_, run_.T_camera0_camera);
  }

  std::optional<SensorFrame>
  next() override
  {
    if (next_ >= positions_.size())
      return std::nullopt;
    const std::size_t i = positions_[next_++];
    const CloudFrame frame =
        clouds_.frame(i, run_.label_set.size(), float(run_.config.label_confidence),
                      mapping_ ? &*mapping_ : nullptr);
    if (frame.distributions.empty() && !frame.cloud->empty() && !told_of_labels_) {
      warn(clouds_.path(i) +
           ": has no field 'label' or 'probability': it gives the map no labels");
      told_of_labels_ = true;
    }
    return frame;
  }

private:
  // Where the sensor is in camera 0, and its camera.
  void
  setSensor()
  {
    const ImagePairFiles& files = arguments_.sequence.files;
    if (arguments_.sensor == "own")
      run_.T_camera0_camera = worldFromFirstCamera().inverse(); // it looks along x
    else if (arguments_.sensor == "laser")
      run_.T_camera0_camera = scannerOf(files.calibration);
    else {
      const RectifiedPair pair = readRectifiedPair(
          {files.calibration, files.extrinsics}, firstCloud(),
          arguments_.sensor == "grey" ? KittiCameras::grey : KittiCameras::colour);
      run_.camera = pair.camera;
      run_.T_camera0_camera = pair.T_camera0_camera;
    }
  }

  static Eigen::Isometry3d
  scannerOf(const std::string& calibration)
  {
    const auto read = readKittiCalibration(calibration, KittiCameras::colour);
    if (!read.T_camera0_velodyne)
      PCL_THROW_EXCEPTION(BadInputException,
                          calibration << ": has no row 'Tr', expected the pose of the "
                                         "laser scanner");
    return *read.T_camera0_velodyne;
  }

  // Its size is that of the camera's images.
  SizedFile
  firstCloud() const
  {
    const std::string& path = clouds_.path(positions_.front());
    const auto cloud = readLabelledCloud(path).cloud;
    if (!cloud->isOrganized())
      PCL_THROW_EXCEPTION(BadInputException,
                          path << ": is no organized cloud, expected one as the "
                                  "camera's images are (or --sensor laser)");
    return {{int(cloud->width), int(cloud->height)}, path};
  }

  MapArguments arguments_;
  std::optional<LabelMapping> mapping_;
  CloudSequence clouds_;
  std::vector<std::size_t> positions_;
  bool told_of_labels_ = false; // a cloud had none
};

} // namespace

namespace {

class RgbdSource : public MapSource {
public:
  explicit RgbdSource(const MapArguments& arguments)
      : sequence_(arguments.rgbd,
                  readPinholeCamera(arguments.sequence.files.calibration),
                  arguments.depth_scale)
  {
    poses_ = arguments.poses;
    labelling_ = makeLabelling(arguments);
    const FrameRange range = parseFrameRange(arguments.frames);
    for (std::size_t i = 0; i < sequence_.size(); ++i)
      if (range.contains(int(i)))
        positions_.push_back(i);
    if (positions_.empty())
      PCL_THROW_EXCEPTION(BadInputException,
                          arguments.rgbd << ": has no frame in " << arguments.frames);
    for (const std::size_t i : positions_)
      run_.frames.push_back(int(i));
    run_.inputs = inputsOf(arguments.sequence);
    run_.inputs.emplace_back("rgbd", arguments.rgbd);
    run_.inputs.emplace_back("depth_scale", shown(arguments.depth_scale));
    addLabelledInputs(arguments, poses_, labelling_.model, run_);
    labelling_.predictor->requireFrames(run_.frames);
    run_.camera = sequence_.camera();
    run_.label_set = labelling_.label_set;
    run_.config = arguments.parameters;
    calibrations_ = readCalibrations(arguments, run_.label_set);
  }

  std::vector<FrameTime>
  times() const override
  {
    std::vector<FrameTime> times;
    for (const std::size_t i : positions_)
      times.push_back({int(i), sequence_.timestamp(i)});
    return times;
  }

  std::unique_ptr<PoseSource>
  openPoses() const override
  {
    return readSensorPoses(poses_);
  }

  std::optional<SensorFrame>
  next() override
  {
    if (next_ >= positions_.size())
      return std::nullopt;
    const std::size_t i = positions_[next_++];
    CloudFrame frame = sequence_.frame(i);
    StereoFrame image;
    static_cast<FrameTime&>(image) = frame;
    image.left = imageOfCloud(*frame.cloud);
    frame.distributions = labelling_.predictor->predict(image);
    return frame;
  }

private:
  RgbdSequence sequence_;
  Labelling labelling_;
  std::vector<std::size_t> positions_;
};

} // namespace

std::unique_ptr<MapSource>
openRgbdSource(const MapArguments& arguments)
{
  return std::make_unique<RgbdSource>(arguments);
}

std::unique_ptr<MapSource>
openCloudSource(const MapArguments& arguments)
{
  return std::make_unique<CloudSource>(arguments);
}

} // namespace pcl_semantic::tool
