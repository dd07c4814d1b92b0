// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/sequence_files.h>

#include "core/fail.h"
#include "files/is_there.h"

#include <pcl_semantic/dataset/kitti_sequence.h>

namespace pcl_semantic {

bool
SequenceFiles::hasFiles() const
{
  return !(files.left.empty() && files.right.empty() && files.calibration.empty() &&
           files.extrinsics.empty() && files.times.empty());
}

const std::string&
SequenceFiles::name() const
{
  return hasFiles() ? files.left : folder;
}

void
SequenceFiles::validate() const
{
  if (!hasFiles() && folder.empty())
    badParameter("expected a SEQUENCE, or --left, --right and --calibration");
  if (!hasFiles())
    return;
  for (const auto& [input, value] : inputs())
    if (input != "sequence" && !folder.empty())
      badParameter("got both a SEQUENCE ('", folder, "') and --", input,
                   ", expected one of them; patterns need quotes");
  for (const auto& [input, value] :
       {std::pair("left", &files.left), std::pair("right", &files.right),
        std::pair("calibration", &files.calibration)})
    if (value->empty())
      badParameter("--", input,
                   " is missing; --left, --right and --calibration belong together");
}

NamedValues
SequenceFiles::inputs() const
{
  NamedValues given;
  for (const auto& [input, value] :
       {std::pair("sequence", &folder), std::pair("left", &files.left),
        std::pair("right", &files.right), std::pair("calibration", &files.calibration),
        std::pair("extrinsics", &files.extrinsics), std::pair("times", &files.times)})
    if (!value->empty())
      given.emplace_back(input, *value);
  return given;
}

ConfigParameters
parametersOf(SequenceFiles& files)
{
  return {{"sequence",
           "folder in the layout of KITTI's odometry benchmark, EuRoC, KITTI-360 or "
           "Middlebury",
           &files.folder},
          {"left",
           "left images of any stereo camera, instead of SEQUENCE: a pattern in quotes "
           "('left/*.png')",
           &files.files.left},
          {"right", "right images, one for each left image", &files.files.right},
          {"calibration",
           "calibration of --left and --right: OpenCV stereoCalibrate, Kalibr "
           "camchain, ROS camera_info or EuRoC sensor.yaml of the left camera (.yaml, "
           ".yml), KITTI or Middlebury (.txt)",
           &files.files.calibration},
          {"extrinsics",
           "file with R and T, if --calibration has none (.yaml); for ROS and EuRoC "
           "the file of the right camera",
           &files.files.extrinsics},
          {"times", "time stamps of the images, one per line [s] (default: 10 Hz)",
           &files.files.times},
          {"strict",
           "reject pairs that look blank, identical, swapped or unrelated instead of "
           "warning",
           &files.strict}};
}

namespace {

// The files of a folder in another layout than KITTI's odometry benchmark; empty if it
// has none of them.
ImagePairFiles
filesOfOtherLayout(const std::string& folder)
{
  for (const std::string& base : {folder + "/mav0", folder}) { // EuRoC (ASL)
    const std::string left = base + "/cam0", right = base + "/cam1";
    if (isFolder(left + "/data"))
      return {left + "/data", right + "/data", left + "/sensor.yaml",
              right + "/sensor.yaml", ""};
  }
  if (isThere(folder + "/im0.png")) // Middlebury, ETH3D
    return {folder + "/im0.png", folder + "/im1.png", folder + "/calib.txt", "", ""};
  if (isFolder(folder + "/image_00/data_rect")) // KITTI-360
    return {folder + "/image_00/data_rect", folder + "/image_01/data_rect",
            folder + "/../../calibration/perspective.txt", "", ""};
  return {};
}

} // namespace

std::unique_ptr<FrameSequence>
openSequence(const SequenceFiles& files, std::vector<std::string>& doubts,
             const VideoOpener& open_videos)
{
  const bool are_videos = isVideo(files.files.left) && isVideo(files.files.right);
  if (are_videos && open_videos)
    return open_videos(files.files);
  if (are_videos)
    badParameter(
        files.files.left,
        ": is a video, expected images; pcl_semantic_live --every-frame maps videos");
  const ImagePairFiles pair_files =
      files.hasFiles() ? files.files : filesOfOtherLayout(files.folder);
  if (pair_files.left.empty())
    return std::make_unique<KittiSequence>(files.folder);
  auto pairs = std::make_unique<ImagePairSequence>(pair_files);
  doubts.insert(doubts.end(), pairs->doubts().begin(), pairs->doubts().end());
  return pairs;
}

} // namespace pcl_semantic
