// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/kitti_sequence.h>

#include "core/fail.h"
#include "files/is_there.h"
#include "stereo_pair_reader.h"

#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <filesystem>
#include <map>

namespace pcl_semantic {

namespace fs = std::filesystem;

KittiSequence::KittiSequence(const std::string& folder, KittiCameras cameras)
    : folder_(folder)
{
  if (!isFolder(folder))
    fail<BadInputException>(folder, ": is no folder, expected a KITTI sequence");
  if (cameras == KittiCameras::automatic)
    cameras = isThere(folder + "/image_2") ? KittiCameras::colour : KittiCameras::grey;
  const bool grey = cameras == KittiCameras::grey;
  findFrames(folder + (grey ? "/image_0" : "/image_2"),
             folder + (grey ? "/image_1" : "/image_3"));
  readTimes();
  calibration_ = readCalibrationOf(
      readFrameImage(frames_.front().left, frames_.front().number).size(),
      frames_.front().left, folder + "/calib.txt", cameras);
}

void
KittiSequence::findFrames(const std::string& left_folder,
                          const std::string& right_folder)
{
  const auto failWithout = [](const std::string& folder, const std::string& path,
                              int frame) {
    fail<BadInputException>(folder, "/", fs::path(path).filename().string(),
                            ": is missing, expected as the partner of ", path,
                            " (frame ", frame, ")");
  };
  const std::vector<FrameFile> left = listFrameFiles(left_folder, {".png"});
  std::map<int, std::string> right;
  for (const FrameFile& file : listFrameFiles(right_folder, {".png"}))
    right[file.frame] = file.path;
  if (left.empty())
    fail<BadInputException>(left_folder, ": holds no images, expected 000000.png ...");
  for (const FrameFile& file : left) {
    const auto partner = right.extract(file.frame);
    if (partner.empty())
      failWithout(right_folder, file.path, file.frame);
    frames_.push_back({file.frame, 0.0, file.path, partner.mapped()});
  }
  if (!right.empty())
    failWithout(left_folder, right.begin()->second, right.begin()->first);
}

void
KittiSequence::readTimes()
{
  const std::string path = folder_ + "/times.txt";
  if (!isThere(path)) {
    for (Entry& entry : frames_)
      entry.timestamp = 0.1 * entry.number;
    return;
  }
  const std::vector<double> times = pcl_semantic::readTimes(path);
  for (Entry& entry : frames_) {
    if (static_cast<std::size_t>(entry.number) >= times.size())
      fail<BadInputException>(path, ": has ", times.size(), " times, but frame ",
                              entry.number, " is there (row = frame number)");
    entry.timestamp = times[static_cast<std::size_t>(entry.number)];
  }
}

StereoFrame
KittiSequence::frame(std::size_t i) const
{
  const Entry& entry = frames_.at(i);
  StereoFrame frame = readStereoPair({entry.left, entry.right, entry.number},
                                     {camera().width, camera().height});
  frame.timestamp = entry.timestamp;
  return frame;
}

const Eigen::Isometry3d&
KittiSequence::T_camera0_velodyne() const
{
  if (!hasVelodyne())
    fail<BadInputException>(
        folder_,
        "/calib.txt: has no row 'Tr:', expected the pose of the laser scanner");
  return *calibration_.T_camera0_velodyne;
}

std::string
KittiSequence::posesPath() const
{
  const std::string path = folder_ + "/poses.txt";
  return isThere(path) ? path : std::string();
}

} // namespace pcl_semantic
