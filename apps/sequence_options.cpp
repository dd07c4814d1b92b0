// SPDX-License-Identifier: BSD-3-Clause
#include "sequence_options.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/dataset/video_pair_sequence.h>

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

void
addSequenceOptions(SequenceOptions& options, po::options_description& description)
{
  ImagePairFiles& files = options.files;
  description.add_options()("sequence", po::value(&options.folder),
                            "folder in KITTI's odometry layout")(
      "left", po::value(&files.left),
      "left images of any stereo camera, instead of SEQUENCE: a pattern in quotes "
      "('left/*.png'), or a video (.mp4, .avi, .mkv, .mov)")(
      "right", po::value(&files.right), "right images, one for each left image")(
      "calibration", po::value(&files.calibration),
      "calibration of --left and --right: of OpenCV's stereoCalibrate, Kalibr's "
      "camchain, "
      "the left camera_info of ROS (.yaml, .yml) or KITTI (.txt)")(
      "extrinsics", po::value(&files.extrinsics),
      "file with R and T, if they are not in --calibration; of ROS the right "
      "camera_info "
      "(.yaml)")("times", po::value(&files.times),
                 "time stamps of the images, one per line [s] (default: 10 Hz)")(
      "strict", po::bool_switch(&options.strict),
      "reject pairs that look blank, identical, swapped or unrelated instead of "
      "warning");
}

void
requireSequence(const SequenceOptions& options, const std::string& program)
{
  const auto fail = [&program](const std::string& message) {
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        message << " (see " << program << " --help)");
  };
  if (!options.hasFiles()) {
    if (options.folder.empty())
      fail("the SEQUENCE is missing, or --left, --right and --calibration");
    return;
  }
  if (!options.folder.empty())
    fail("both a SEQUENCE ('" + options.folder +
         "') and --left, --right, --calibration or --times; patterns need quotes");
  const ImagePairFiles& files = options.files;
  for (const auto& [name, value] :
       {std::pair("--left", &files.left), std::pair("--right", &files.right),
        std::pair("--calibration", &files.calibration)})
    if (value->empty())
      fail(std::string(name) +
           " is missing; --left, --right and --calibration belong together");
}

std::unique_ptr<FrameSequence>
openSequence(const SequenceOptions& options)
{
  if (isVideo(options.files.left) && isVideo(options.files.right))
    return std::make_unique<VideoPairSequence>(options.files);
  if (options.hasFiles())
    return std::make_unique<ImagePairSequence>(options.files);
  return std::make_unique<KittiSequence>(options.folder);
}

std::vector<std::size_t>
chooseFrames(const SequenceOptions& options, const FrameSequence& sequence,
             const std::string& range)
{
  std::vector<std::size_t> frames = selectFrames(sequence, parseFrameRange(range));
  if (frames.empty())
    PCL_THROW_EXCEPTION(BadInputException, options.name()
                                               << ": has no frame in " << range);
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
    PCL_THROW_EXCEPTION(BadInputException, name << ": has no frame in " << range);
  return positions;
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

} // namespace pcl_semantic::tool
