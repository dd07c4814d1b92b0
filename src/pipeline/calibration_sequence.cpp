// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/labelling/stored_predictor.h>
#include <pcl_semantic/odometry/trajectory_poses.h>
#include <pcl_semantic/pipeline/calibration_sequence.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <filesystem>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

std::string
lastPartOf(const std::string& path)
{
  const fs::path normal = (fs::path(path) / "").lexically_normal().parent_path();
  return normal.filename().string();
}

} // namespace

CalibrationSequence::CalibrationSequence(const CalibrationFolders& folders, int classes)
    : folders_(folders), sequence_(folders.sequence), classes_(classes),
      name_(lastPartOf(folders.sequence))
{
  const std::string poses = sequence_.posesPath();
  if (poses.empty())
    PCL_THROW_EXCEPTION(BadInputException, folders.sequence
                                               << ": has no poses.txt; write it with "
                                                  "pcl_semantic_odometry");
  trajectory_ = readKittiTrajectory(poses);
  const std::vector<std::size_t> chosen = selectFrames(sequence_, folders.frames);
  for (const std::size_t i : chosen)
    frames_.push_back(sequence_.frame(i));
  makePoses()->requirePoses(frameTimes(sequence_, chosen));
  readTruth();
}

void
CalibrationSequence::readTruth()
{
  truths_.resize(frames_.size());
  bool has_truth = false;
  for (const FrameFile& file : listFrameFiles(folders_.truth, {".png"})) {
    const auto frame =
        std::find_if(frames_.begin(), frames_.end(), [&](const StereoFrame& each) {
          return each.number == file.frame;
        });
    if (frame == frames_.end())
      continue;
    cv::Mat& truth = truths_[std::size_t(frame - frames_.begin())];
    truth = readPng(file.path, ImageKind::labels);
    double largest = 0.0;
    cv::minMaxLoc(truth, nullptr, &largest);
    if (truth.size() != frame->left.size() || largest > classes_)
      PCL_THROW_EXCEPTION(BadInputException,
                          file.path << ": " << truth.cols << " x " << truth.rows
                                    << " pixels with labels up to " << largest
                                    << ", expected " << frame->left.cols << " x "
                                    << frame->left.rows << " up to " << classes_);
    has_truth = true;
  }
  if (!has_truth)
    PCL_THROW_EXCEPTION(BadInputException, folders_.truth
                                               << ": has no truth image of a frame of "
                                               << folders_.sequence);
}

std::unique_ptr<LabelPredictor>
CalibrationSequence::makePredictor(double png_confidence) const
{
  return std::make_unique<StoredPredictor>(folders_.labels, classes_,
                                           float(png_confidence));
}

std::unique_ptr<PoseSource>
CalibrationSequence::makePoses() const
{
  return std::make_unique<TrajectoryPoses>(trajectory_, sequence_.T_camera0_camera(),
                                           sequence_.posesPath());
}

} // namespace pcl_semantic
