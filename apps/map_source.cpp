// SPDX-License-Identifier: BSD-3-Clause
#include "map_source.h"
#include "files/is_there.h"
#include "map_labelling.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/camera_doubts.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/dataset/lidar_scan.h>
#include <pcl_semantic/dataset/rectifier.h>
#include <pcl_semantic/dataset/rgbd_sequence.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/labelling/visible_points.h>
#include <pcl_semantic/map/map_doubts.h>
#include <pcl_semantic/odometry/stereo_odometry.h>
#include <pcl_semantic/odometry/trajectory_poses.h>
#include <pcl_semantic/pipeline/frame_digest.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>

namespace pcl_semantic::tool {

MapSource::MapSource(const MapArguments& arguments) : arguments_(arguments)
{
  run_.config = arguments.parameters;
  warnOf(doubtsOf(run_.config.map));
}

std::unique_ptr<SemanticMapper>
MapSource::makeMapper(std::unique_ptr<PoseSource> poses,
                      std::shared_ptr<BlockStore> store)
{
  auto mapper = std::make_unique<SemanticMapper>(
      run_.label_set, run_.config, std::move(poses), run_.camera, std::move(predictor_),
      std::move(store));
  if (label_calibration_)
    mapper->setLabelCalibration(*label_calibration_);
  if (clique_calibration_)
    mapper->setCliqueCalibration(*clique_calibration_);
  return mapper;
}

namespace {

// The words of --also as a value that is no path.
std::string
wordsIn(const std::string& also)
{
  std::vector<std::string> words = splitAtCommas(also);
  std::sort(words.begin(), words.end());
  std::string text;
  for (const std::string& word : words)
    text += (text.empty() ? "[" : ", ") + word;
  return text.empty() ? text : text + "]";
}

} // namespace

void
MapSource::setInputs(const Inputs& more)
{
  run_.inputs = inputsOf(arguments_.sequence);
  run_.inputs.insert(run_.inputs.end(), more.begin(), more.end());
  run_.inputs.insert(run_.inputs.end(),
                     {{"label_calibration", arguments_.label_calibration},
                      {"clique_calibration", arguments_.clique_calibration},
                      {"also", wordsIn(arguments_.also)}});
}

void
MapSource::readCalibrations()
{
  if (!arguments_.label_calibration.empty())
    label_calibration_ = readCalibration(arguments_.label_calibration, run_.label_set);
  if (!arguments_.clique_calibration.empty())
    clique_calibration_ =
        readCalibration(arguments_.clique_calibration, run_.label_set, "cliques");
}

namespace {

// What lies there whole before the first frame is read.
class RecordedSource : public MapSource {
public:
  std::vector<FrameTime>
  times() const override
  {
    std::vector<FrameTime> times;
    for (std::size_t i = 0; i < positions_.size(); ++i)
      times.push_back({run_.frames[i], timestamp(positions_[i])});
    return times;
  }

  std::optional<SensorFrame>
  next() override
  {
    if (next_ >= positions_.size())
      return std::nullopt;
    return read(positions_[next_++]);
  }

  void
  skip(const std::vector<FrameRecord>& mapped) override
  {
    const std::string change = changeSince(mapped);
    if (!change.empty())
      fail<BadInputException>(arguments_.archive.path, ": holds ", change,
                              " as it was, which is another one now: put the old data "
                              "back, or begin with another archive");
    next_ = mapped.size();
  }

  std::string
  changeSince(const std::vector<FrameRecord>& mapped) override
  {
    std::string change;
    for (std::size_t i = 0; i < mapped.size() && change.empty(); ++i)
      change = i < positions_.size() && mapped[i].number == run_.frames[i]
                   ? changeOf(i, mapped[i])
                   : "frame " + std::to_string(mapped[i].number);
    next_ = 0;
    return change;
  }

protected:
  using MapSource::MapSource;

  /** \brief Those of run_.frames whose labels are used (network_every). */
  std::vector<int>
  labelledFrames() const
  {
    std::vector<int> labelled;
    for (std::size_t i = 0; i < run_.frames.size();
         i += std::size_t(run_.config.network_every))
      labelled.push_back(run_.frames[i]);
    return labelled;
  }

  /** \brief Whether the frame that is being read is one of them. */
  bool
  isLabelled() const
  {
    return (next_ - 1) % std::size_t(run_.config.network_every) == 0;
  }

  // What of a frame is another one now. The labels of a network are not looked at: its
  // images and the network itself are.
  std::string
  changeOf(std::size_t i, const FrameRecord& mapped)
  {
    next_ = i;
    is_compared_ = true;
    const SensorFrame frame = *next();
    is_compared_ = false;
    FrameDigest now;
    if (const auto* const pair = std::get_if<StereoFrame>(&frame))
      now = digestOf(*pair, isLabelled() && !arguments_.labels.empty()
                                ? predictor_->predict(*pair)
                                : LabelDistributions());
    else
      now = digestOf(*std::get<CloudFrame>(frame).cloud,
                     isLabelled() ? std::get<CloudFrame>(frame).distributions
                                  : LabelDistributions());
    const auto differ = [](std::uint64_t a, std::uint64_t b) {
      return a != 0 && b != 0 && a != b;
    };
    const std::string name = "frame " + std::to_string(mapped.number);
    if (differ(mapped.digest.data, now.data))
      return name;
    if (differ(mapped.digest.labels, now.labels))
      return "labels of " + name;
    // NaN: not known
    const double time = timestamp(positions_[i]);
    return mapped.timestamp < time || mapped.timestamp > time ? "time of " + name : "";
  }

  /** \brief Whether the frame that is being read was mapped already, and is looked at
   * once more. */
  bool
  isCompared() const
  {
    return is_compared_;
  }

  /** \brief Reads the frame at a position in the source. */
  virtual SensorFrame read(std::size_t position) = 0;

  virtual double timestamp(std::size_t position) const = 0;

  std::vector<std::size_t> positions_; ///< in the source, of the frames that are mapped

private:
  std::size_t next_ = 0; // of positions_
  bool is_compared_ = false;
};

using ScanReader = decltype(ExtraOptions::scan);

// Reads the laser scans beside the images of a sequence.
ScanReader
scansOf(const FrameSequence& sequence, const std::vector<std::size_t>& frames,
        const ScanColumns& columns)
{
  const auto* const kitti = dynamic_cast<const KittiSequence*>(&sequence);
  if (!kitti)
    fail<InvalidParameterException>(
        "--also scans needs a SEQUENCE with laser scans (velodyne), or --clouds");
  const std::string folder = kitti->folder() + "/velodyne/";
  const Eigen::Isometry3d T_camera_scanner =
      kitti->T_camera0_camera().inverse() * kitti->T_camera0_velodyne();
  for (const std::size_t i : frames) {
    const std::string scan = folder + frameFileName(kitti->frameNumber(i), ".bin");
    if (!isThere(scan))
      fail<BadInputException>(scan, ": is missing; --also scans needs one a frame");
  }
  return [=](int frame) {
    return pointsInCamera(
        *readVelodyneScan(folder + frameFileName(frame, ".bin"), columns),
        T_camera_scanner);
  };
}

// What --also asks for.
// \param[in] openScans is called if it is for scans
ExtraOptions
makeExtras(const MapArguments& arguments, const std::function<ScanReader()>& openScans)
{
  if (!(arguments.scan_within >= 0.0 && arguments.scan_within <= 2.0))
    fail<InvalidParameterException>("--scan-within is ", arguments.scan_within,
                                    ", expected 0 to 2");
  ExtraOptions extra;
  extra.images = !arguments.map_only;
  extra.centres = arguments.centres;
  extra.within = arguments.scan_within;
  for (const std::string& word : splitAtCommas(arguments.also))
    if (word == "measured")
      extra.measured = true;
    else if (word == "depth")
      extra.depth = true;
    else if (word == "probabilities")
      extra.probabilities = true;
    else if (word == "scans")
      extra.scan = openScans();
    else
      fail<InvalidParameterException>(
          "--also: '", word, "', expected measured, depth, probabilities or scans");
  if (!extra.images && (extra.measured || extra.depth || extra.probabilities))
    fail<InvalidParameterException>("--also measured, depth and probabilities need the "
                                    "images that --map-only leaves out");
  return extra;
}

// Path of a trajectory, or "odometry".
std::string
choosePoses(const MapArguments& arguments, const FrameSequence& sequence)
{
  if (arguments.poses != "auto" && arguments.poses != "sequence")
    return arguments.poses;
  const std::string path = sequence.posesPath();
  if (!path.empty())
    return path;
  if (arguments.poses == "sequence")
    fail<BadInputException>(arguments.sequence.name(),
                            ": has no poses.txt; give a trajectory with --poses");
  if (!arguments.archive.path.empty())
    fail<InvalidParameterException>("--archive needs poses from a file, but ",
                                    arguments.sequence.name(),
                                    " has no poses.txt; write them with "
                                    "pcl_semantic_odometry and give them with --poses");
  return "odometry";
}

class SequenceSource : public RecordedSource {
public:
  explicit SequenceSource(const MapArguments& arguments)
      : RecordedSource(arguments), sequence_(openSequence(arguments.sequence)),
        watch_(arguments.sequence.strict, sequence_->camera()),
        poses_(choosePoses(arguments, *sequence_))
  {
    MapLabelling labelling = makeLabelling(arguments);
    positions_ = chooseFrames(arguments.sequence, *sequence_, arguments.frames);
    setInputs({{"poses", poses_},
               {"labels", arguments.labels},
               {"label_mapping", arguments.label_mapping},
               {"network", arguments.network},
               {"model", labelling.model},
               {"engine", labelling.engine}});
    for (const std::size_t i : positions_)
      run_.frames.push_back(sequence_->frameNumber(i));
    labelling.predictor->requireFrames(labelledFrames());
    run_.camera = sequence_->camera();
    run_.T_camera0_camera = sequence_->T_camera0_camera();
    run_.label_set = labelling.label_set;
    predictor_ = std::move(labelling.predictor);
    watch_of_mapping_ = std::move(labelling.watch);
    extras_ = makeExtras(arguments, [&] {
      return scansOf(*sequence_, positions_, columnsOf(arguments.scan_columns));
    });
    readCalibrations();
  }

  std::unique_ptr<PoseSource>
  openPoses(std::vector<std::string>& doubts) const override
  {
    if (poses_ == "odometry")
      return std::make_unique<StereoOdometry>(sequence_->camera(),
                                              run_.T_camera0_camera);
    return readPoses(poses_, run_.T_camera0_camera, &doubts);
  }

private:
  SensorFrame
  read(std::size_t position) override
  {
    const StereoFrame pair = sequence_->frame(position);
    if (!isCompared())
      watch_.look(pair);
    return pair;
  }

  double
  timestamp(std::size_t position) const override
  {
    return sequence_->timestamp(position);
  }

  std::unique_ptr<FrameSequence> sequence_;
  PairWatch watch_;
  std::string poses_; // path of the trajectory, or "odometry"
};

class CloudSource : public RecordedSource {
public:
  explicit CloudSource(const MapArguments& arguments)
      : RecordedSource(arguments),
        clouds_(arguments.clouds, arguments.sequence.files.times,
                columnsOf(arguments.scan_columns))
  {
    std::error_code error;
    if (std::filesystem::equivalent(arguments.poses,
                                    arguments.output + "/trajectory.txt", error))
      fail<InvalidParameterException>(
          "--poses is where --output puts its own trajectory");
    if (std::filesystem::equivalent(arguments.clouds, arguments.output, error))
      fail<InvalidParameterException>(
          "--output holds the clouds; maps need a folder of their own");
    run_.label_set = readLabelSetOrDefault(arguments.label_set);
    if (!arguments.label_mapping.empty())
      mapping_ = readLabelMapping(arguments.label_mapping, run_.label_set);
    if (mapping_)
      watch_of_mapping_ = MappingWatch(arguments.label_mapping, *mapping_, "points");
    positions_ = chooseClouds(arguments.clouds, clouds_, arguments.frames);
    for (const std::size_t i : positions_)
      run_.frames.push_back(clouds_.frameNumber(i));
    refuseOptionsOfLabels();
    setSensor();
    setInputs({{"clouds", arguments.clouds},
               {"label_mapping", arguments.label_mapping},
               {"sensor", arguments.sensor},
               {"poses", arguments.poses}});
    if (!arguments.scan_columns.empty())
      run_.inputs.emplace_back("scan_columns", "[" + arguments.scan_columns + "]");
    readCalibrations();
    setExtras();
  }

  std::unique_ptr<PoseSource>
  openPoses(std::vector<std::string>& doubts) const override
  {
    if (arguments_.poses == "viewpoint")
      return std::make_unique<ViewpointPoses>();
    return arguments_.sensor == "own"
               ? readSensorPoses(arguments_.poses, PoseFrame::sensor, &doubts)
               : readPoses(arguments_.poses, run_.T_camera0_camera, &doubts);
  }

private:
  SensorFrame
  read(std::size_t position) override
  {
    std::vector<std::string> doubts;
    const CloudFrame frame = clouds_.frame(position, run_.label_set.size(),
                                           float(run_.config.label_confidence),
                                           mapping_ ? &*mapping_ : nullptr, &doubts);
    if (!told_of_doubts_)
      warnOf(doubts);
    told_of_doubts_ = told_of_doubts_ || !doubts.empty();
    if (frame.distributions.empty() && !frame.cloud->empty() && !told_of_labels_) {
      warn(clouds_.path(position) +
           ": has no field 'label' or 'probability': it gives the map no labels");
      told_of_labels_ = true;
    }
    warnOfViewpoint(frame, clouds_.path(position));
    return frame;
  }

  // A cloud that states another pose than the one in use may be meant by it.
  void
  warnOfViewpoint(const CloudFrame& frame, const std::string& path)
  {
    const bool is_default = // what most files say
        frame.viewpoint.matrix() == Eigen::Matrix4d::Identity();
    default_viewpoints_ += is_default;
    if (arguments_.poses == "viewpoint" && default_viewpoints_ == 2)
      warn(path + ": the VIEWPOINT of a second cloud is the default, 0 0 0 1 0 0 0: do "
                  "the files state poses?");
    if (told_of_viewpoint_ || is_default || !frame.viewpoint.matrix().allFinite())
      return;
    if (!own_poses_) {
      std::vector<std::string> told;
      own_poses_ = openPoses(told);
    }
    const Eigen::Isometry3d used = poseAt(*own_poses_, frame);
    if (arguments_.poses == "viewpoint" || frame.viewpoint.isApprox(used, 1e-3))
      return;
    TextStream text;
    text << path << ": its VIEWPOINT, at " << frame.viewpoint.translation().transpose()
         << ", is not used, its pose of " << arguments_.poses << " is at "
         << used.translation().transpose() << " (--poses viewpoint uses it)";
    warn(text.str());
    told_of_viewpoint_ = true;
  }

  double
  timestamp(std::size_t position) const override
  {
    return clouds_.timestamp(position);
  }

  void
  setExtras()
  {
    extras_ = makeExtras(arguments_, [&] { return scans(); });
    if (!run_.camera && (extras_.depth || extras_.probabilities))
      fail<InvalidParameterException>(
          "--also depth and probabilities are for frames of a camera");
    if (!run_.camera && extras_.measured && !extras_.scan)
      fail<InvalidParameterException>(
          "--also measured of clouds without a camera needs scans, too");
  }

  // The clouds themselves.
  ScanReader
  scans() const
  {
    std::map<int, std::string> paths;
    for (const std::size_t i : positions_)
      paths[clouds_.frameNumber(i)] = clouds_.path(i);
    return [paths, columns = arguments_.scan_columns](int frame) {
      const std::string& path = paths.at(frame);
      return readPositions(path, columnsOf(columns, path));
    };
  }

  // The first cloud that has labels says what the others have; of those that differ
  // the reader warns.
  void
  refuseOptionsOfLabels() const
  {
    std::vector<std::string> given;
    if (arguments_.states_confidence)
      given.emplace_back("--label-confidence");
    if (mapping_)
      given.emplace_back("--label-mapping");
    for (std::size_t i = 0; i < positions_.size() && !given.empty(); ++i) {
      const std::string& path = clouds_.path(positions_[i]);
      const LabelledCloud cloud = readLabelledCloud(
          path, &anyLabels(), columnsOf(arguments_.scan_columns, path));
      if (!cloud.has_labels || cloud.cloud->empty())
        continue;
      if (cloud.distributions.classes() > 0)
        refuseForProbabilities(path, given);
      return;
    }
  }

  // Where the sensor is in camera 0, and its camera.
  void
  setSensor()
  {
    const ImagePairFiles& files = arguments_.sequence.files;
    if (arguments_.sensor == "own" || arguments_.sensor == "laser")
      run_.T_camera0_camera = scannerPose(arguments_.sensor, files.calibration);
    else {
      const RectifiedPair pair = readRectifiedPair(
          {files.calibration, files.extrinsics}, firstCloud(),
          arguments_.sensor == "grey" ? KittiCameras::grey : KittiCameras::colour);
      warnOf(pair.doubts);
      warnOf(doubtsOf(pair.camera));
      run_.camera = pair.camera;
      run_.T_camera0_camera = pair.T_camera0_camera;
    }
  }

  // Its size is that of the camera's images. Clouds of no points say nothing.
  SizedFile
  firstCloud() const
  {
    for (const std::size_t position : positions_) {
      const std::string& path = clouds_.path(position);
      const auto cloud = readLabelledCloud(path, &anyLabels(),
                                           columnsOf(arguments_.scan_columns, path))
                             .cloud;
      if (cloud->empty())
        continue;
      if (!cloud->isOrganized())
        fail<BadInputException>(path, ": is no organized cloud, expected one as the "
                                      "camera's images are (or --sensor laser)");
      return {{int(cloud->width), int(cloud->height)}, path};
    }
    fail<BadInputException>(arguments_.clouds, ": no cloud has a point");
  }

  std::optional<LabelMapping> mapping_;
  CloudSequence clouds_;
  bool told_of_labels_ = false; // a cloud had none
  int default_viewpoints_ = 0;
  bool told_of_viewpoint_ = false;
  std::unique_ptr<PoseSource> own_poses_; // to compare viewpoints with
  bool told_of_doubts_ = false;           // of the first cloud that had some
};

// An RGB-D sequence, whose images are labelled as those of pairs are.
class RgbdSource : public RecordedSource {
public:
  explicit RgbdSource(const MapArguments& arguments)
      : RecordedSource(arguments),
        sequence_(arguments.rgbd,
                  readPinholeCamera(arguments.sequence.files.calibration),
                  arguments.depth_scale),
        labelling_(makeLabelling(arguments))
  {
    const FrameRange range = parseFrameRange(arguments.frames);
    for (std::size_t i = 0; i < sequence_.size(); ++i)
      if (range.contains(int(i))) {
        positions_.push_back(i);
        run_.frames.push_back(int(i));
      }
    if (positions_.empty())
      fail<BadInputException>(arguments.rgbd, ": has no frame in ", arguments.frames);
    setInputs({{"rgbd", arguments.rgbd},
               {"depth_scale", shown(arguments.depth_scale)},
               {"poses", arguments.poses},
               {"labels", arguments.labels},
               {"label_mapping", arguments.label_mapping},
               {"network", arguments.network},
               {"model", labelling_.model},
               {"engine", labelling_.engine}});
    labelling_.predictor->requireFrames(labelledFrames());
    warnOf(sequence_.doubts());
    run_.camera = sequence_.camera();
    run_.label_set = labelling_.label_set;
    extras_ = makeExtras(arguments, [] { return ScanReader(); }); // it has no scans
    readCalibrations();
  }

  Results
  figures() const override
  {
    return {{"pixels_without_depth", pixels_without_depth_}};
  }

  std::unique_ptr<PoseSource>
  openPoses(std::vector<std::string>& doubts) const override
  {
    return readSensorPoses(arguments_.poses, PoseFrame::camera, &doubts);
  }

private:
  SensorFrame
  read(std::size_t position) override
  {
    std::size_t unmeasured = 0;
    CloudFrame frame = sequence_.frame(position, 0.0, &unmeasured);
    if (!isCompared())
      pixels_without_depth_ += unmeasured;
    if (!isLabelled() || (isCompared() && !arguments_.network.empty()))
      return frame;
    StereoFrame image;
    static_cast<FrameTime&>(image) = frame;
    image.left = imageOfCloud(*frame.cloud);
    frame.distributions = labelling_.predictor->predict(image);
    return frame;
  }

  double
  timestamp(std::size_t position) const override
  {
    return sequence_.timestamp(position);
  }

  RgbdSequence sequence_;
  MapLabelling labelling_;
  std::size_t pixels_without_depth_ = 0;
};

} // namespace

std::unique_ptr<MapSource>
openMapSource(const MapArguments& arguments)
{
  if (!arguments.rgbd.empty())
    return std::make_unique<RgbdSource>(arguments);
  if (!arguments.clouds.empty())
    return std::make_unique<CloudSource>(arguments);
  return std::make_unique<SequenceSource>(arguments);
}

} // namespace pcl_semantic::tool
