// SPDX-License-Identifier: BSD-3-Clause
#include "stereo_pair_reader.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <algorithm>
#include <filesystem>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

void
requirePartner(const std::vector<FrameFile>& files, const FrameFile& file,
               const std::string& folder)
{
  const bool found =
      std::any_of(files.begin(), files.end(),
                  [&](const FrameFile& other) { return other.frame == file.frame; });
  if (!found)
    PCL_THROW_EXCEPTION(BadInputException,
                        folder << "/" << fs::path(file.path).filename().string()
                               << ": is missing, expected as the partner of "
                               << file.path << " (frame " << file.frame << ")");
}

} // namespace

KittiSequence::KittiSequence(const std::string& folder, KittiCameras cameras)
    : folder_(folder)
{
  if (!fs::is_directory(folder))
    PCL_THROW_EXCEPTION(BadInputException,
                        folder << ": is no folder, expected a KITTI sequence");
  if (cameras == KittiCameras::automatic)
    cameras = fs::is_directory(folder + "/image_2") ? KittiCameras::colour
                                                    : KittiCameras::grey;
  const bool grey = cameras == KittiCameras::grey;
  findFrames(folder + (grey ? "/image_0" : "/image_2"),
             folder + (grey ? "/image_1" : "/image_3"));
  readTimes();
  calibration_ = readCalibrationOf(
      readFrameImage(frames_.front().left, frames_.front().number).size(),
      folder + "/calib.txt", cameras);
}

void
KittiSequence::findFrames(const std::string& left_folder,
                          const std::string& right_folder)
{
  const std::vector<FrameFile> left = listFrameFiles(left_folder, {".png"});
  const std::vector<FrameFile> right = listFrameFiles(right_folder, {".png"});
  if (left.empty())
    PCL_THROW_EXCEPTION(BadInputException,
                        left_folder << ": holds no images, expected 000000.png ...");
  for (std::size_t i = 0; i < std::max(left.size(), right.size()); ++i) {
    const bool both = i < left.size() && i < right.size();
    if (both && left[i].frame == right[i].frame)
      frames_.push_back({left[i].frame, 0.0, left[i].path, right[i].path});
    else if (i >= right.size() || (both && left[i].frame < right[i].frame))
      requirePartner(right, left[i], right_folder);
    else
      requirePartner(left, right[i], left_folder);
  }
}

void
KittiSequence::readTimes()
{
  const std::string path = folder_ + "/times.txt";
  if (!fs::exists(path)) {
    for (Entry& entry : frames_)
      entry.timestamp = 0.1 * entry.number;
    return;
  }
  const std::vector<double> times = pcl_semantic::readTimes(path);
  for (Entry& entry : frames_) {
    if (static_cast<std::size_t>(entry.number) >= times.size())
      PCL_THROW_EXCEPTION(BadInputException,
                          path << ": has " << times.size() << " times, but frame "
                               << entry.number << " is there (row = frame number)");
    entry.timestamp = times[static_cast<std::size_t>(entry.number)];
  }
}

StereoFrame
KittiSequence::frame(std::size_t i) const
{
  const Entry& entry = frames_.at(i);
  StereoFrame frame =
      readStereoPair({entry.left, entry.right, entry.number},
                     {camera().width, camera().height}, "the first image");
  frame.timestamp = entry.timestamp;
  return frame;
}

const Eigen::Isometry3d&
KittiSequence::T_camera0_velodyne() const
{
  if (!hasVelodyne())
    PCL_THROW_EXCEPTION(BadInputException,
                        folder_ << "/calib.txt: has no row 'Tr:', expected the pose of "
                                   "the laser scanner");
  return *calibration_.T_camera0_velodyne;
}

std::string
KittiSequence::posesPath() const
{
  const std::string path = folder_ + "/poses.txt";
  return fs::exists(path) ? path : std::string();
}

} // namespace pcl_semantic
