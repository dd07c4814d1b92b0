// SPDX-License-Identifier: BSD-3-Clause
#include "sequence_options.h"
#include "cloud_doubts.h"
#include "messages.h"

#include "core/fail.h"

#include <pcl_semantic/core/camera_doubts.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/dataset/kitti_calibration.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/labelling/visible_points.h>
#include <pcl_semantic/odometry/pose_source.h>

#include <cmath>

namespace pcl_semantic::tool {

bool
SequenceOptions::hasFiles() const
{
  return !(files.left.empty() && files.right.empty() && files.calibration.empty() &&
           files.extrinsics.empty() && files.times.empty());
}

const std::string&
SequenceOptions::name() const
{
  return hasFiles() ? files.left : folder;
}

std::vector<Option>
withSequence(SequenceOptions& options, const std::vector<Option>& more)
{
  ImagePairFiles& files = options.files;
  std::vector<Option> all = {
      {"sequence", options.folder, "folder in KITTI's odometry layout"},
      {"left", files.left,
       "left images of any stereo camera, instead of SEQUENCE: a pattern in quotes "
       "('left/*.png')"},
      {"right", files.right, "right images, one for each left image"},
      {"calibration", files.calibration,
       "calibration of --left and --right: of OpenCV's stereoCalibrate, Kalibr's "
       "camchain, the left camera_info of ROS or sensor.yaml of EuRoC (.yaml, .yml), "
       "KITTI or Middlebury (.txt)"},
      {"extrinsics", files.extrinsics,
       "file with R and T, if they are not in --calibration; of ROS and EuRoC that of "
       "the right camera (.yaml)"},
      {"times", files.times,
       "time stamps of the images, one per line [s] (default: 10 Hz)"},
      {"strict", options.strict,
       "reject pairs that look blank, identical, swapped or unrelated instead of "
       "warning"}};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

void
requireSequence(const SequenceOptions& options)
{
  if (!options.hasFiles())
    return refuseIf(options.folder.empty(),
                    "the SEQUENCE is missing, or --left, --right and --calibration");
  const ImagePairFiles& files = options.files;
  for (const auto& [name, value] :
       {std::pair("--left", &files.left), std::pair("--right", &files.right),
        std::pair("--calibration", &files.calibration),
        std::pair("--extrinsics", &files.extrinsics),
        std::pair("--times", &files.times)})
    refuseIf(!value->empty() && !options.folder.empty(),
             "both a SEQUENCE ('" + options.folder + "') and " + name +
                 "; patterns need quotes");
  for (const auto& [name, value] :
       {std::pair("--left", &files.left), std::pair("--right", &files.right),
        std::pair("--calibration", &files.calibration)})
    refuseIf(value->empty(), std::string(name) + " is missing; --left, --right and "
                                                 "--calibration belong together");
}

std::unique_ptr<FrameSequence>
openSequence(const SequenceOptions& options)
{
  const bool are_videos = isVideo(options.files.left) && isVideo(options.files.right);
  if (are_videos && options.open_videos)
    return options.open_videos(options.files);
  if (are_videos)
    fail<InvalidParameterException>(
        options.files.left, ": is a video, which pcl_semantic_live --every-frame maps");
  if (!options.hasFiles())
    return std::make_unique<KittiSequence>(options.folder);
  auto pairs = std::make_unique<ImagePairSequence>(options.files);
  warnOf(pairs->doubts());
  return pairs;
}

std::vector<std::size_t>
chooseFrames(const SequenceOptions& options, const FrameSequence& sequence,
             const std::string& range)
{
  std::vector<std::size_t> frames = selectFrames(sequence, parseFrameRange(range));
  if (frames.empty())
    fail<BadInputException>(options.name(), ": has no frame in ", range);
  return frames;
}

std::vector<std::size_t>
chooseClouds(const std::string& name, const CloudSequence& clouds,
             const std::string& range)
{
  const FrameRange chosen = parseFrameRange(range);
  std::vector<std::size_t> positions;
  for (std::size_t i = 0; i < clouds.size(); ++i)
    if (chosen.contains(clouds.frameNumber(i)))
      positions.push_back(i);
  if (positions.empty())
    fail<BadInputException>(name, ": has no frame in ", range);
  return positions;
}

std::vector<Eigen::Vector3d>
readPositions(const std::string& path, const ScanColumns& columns)
{
  LabelledCloud read = readLabelledCloud(path, &anyLabels(), columns);
  addOrigin(read);
  return pointsInCamera(*read.cloud, Eigen::Isometry3d::Identity());
}

Eigen::Isometry3d
scannerPose(const std::string& sensor, const std::string& calibration)
{
  if (sensor == "own")
    return worldFromFirstCamera().inverse();
  const auto read = readKittiCalibration(calibration, KittiCameras::colour);
  if (!read.T_camera0_velodyne)
    fail<BadInputException>(
        calibration, ": has no row 'Tr', expected the pose of the laser scanner");
  return *read.T_camera0_velodyne;
}

std::vector<std::string>
textFilesOf(const SequenceOptions& options, const FrameSequence& sequence)
{
  if (options.hasFiles())
    return {options.files.calibration, options.files.extrinsics, options.files.times};
  return {sequence.posesPath(), options.folder + "/calib.txt",
          options.folder + "/times.txt"};
}

std::vector<std::pair<std::string, std::string>>
inputsOf(const SequenceOptions& options)
{
  std::vector<std::pair<std::string, std::string>> inputs;
  const ImagePairFiles& files = options.files;
  for (const auto& [name, value] :
       {std::pair("sequence", &options.folder), std::pair("left", &files.left),
        std::pair("right", &files.right), std::pair("calibration", &files.calibration),
        std::pair("extrinsics", &files.extrinsics), std::pair("times", &files.times)})
    if (!value->empty())
      inputs.emplace_back(name, *value);
  return inputs;
}

PairWatch::PairWatch(bool strict, const StereoCamera& camera) : strict_(strict)
{
  const std::vector<std::string> doubts = doubtsOf(camera);
  if (strict_ && !doubts.empty())
    throw BadInputException(doubts.front());
  warnOf(doubts);
}

PairWatch::~PairWatch()
{
  for (const auto& [fault, pairs] : warned_)
    if (pairs > 1)
      warn(std::to_string(pairs) + " pairs looked " +
           (fault == PairFault::blank       ? "blank"
            : fault == PairFault::identical ? "identical"
            : fault == PairFault::swapped   ? "swapped"
                                            : "unrelated"));
}

void
PairWatch::look(const StereoFrame& frame, const std::string& name)
{
  const PairReport report = checkPair(frame.left, frame.right);
  if (report.fault == PairFault::none)
    return;
  if (strict_)
    throw BadInputException(name + ": " + report.reason);
  if (++warned_[report.fault] == 1)
    warn(name + ": " + report.reason);
}

} // namespace pcl_semantic::tool
