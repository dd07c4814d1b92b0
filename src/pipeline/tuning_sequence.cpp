// SPDX-License-Identifier: BSD-3-Clause
#include "digest.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/labelling/stored_predictor.h>
#include <pcl_semantic/odometry/trajectory_poses.h>
#include <pcl_semantic/pipeline/tuning_sequence.h>
#include <pcl_semantic/stereo/disparity_engines.h>
#include <pcl_semantic/version.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include <dlfcn.h>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

std::string
lastPartOf(const std::string& path)
{
  const fs::path normal = (fs::path(path) / "").lexically_normal().parent_path();
  return normal.filename().string();
}

void
addTo(Digest& digest, const cv::Mat& image)
{
  for (int row = 0; row < image.rows; ++row)
    digest.add(image.ptr(row), std::size_t(image.cols) * image.elemSize());
}

// Of the file that holds this code, library or program: another build may give other
// results.
std::uint64_t
digestOfProgram()
{
  Digest digest;
  Dl_info info;
  if (dladdr(reinterpret_cast<const void*>(&digestOfProgram), &info) != 0) {
    const std::vector<std::uint8_t> bytes = readBytes(info.dli_fname);
    digest.add(bytes.data(), bytes.size());
  }
  return digest.value();
}

} // namespace

TuningSequence::TuningSequence(const TuningFolders& folders, int classes)
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
  digest_ = digestOfData();
}

void
TuningSequence::readTruth()
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

// Reads everything once: what is wrong with it is found before anything is run.
std::uint64_t
TuningSequence::digestOfData() const
{
  Digest digest;
  const auto predictor = makePredictor(1.0);
  const auto poses = makePoses();
  for (const StereoFrame& frame : frames_) {
    addTo(digest, frame.left);
    addTo(digest, frame.right);
    const Eigen::Matrix4d pose = poses->pose(frame).matrix();
    digest.add(pose.data(), sizeof(double) * 16);
    const LabelDistributions labels = predictor->predict(frame);
    digest.add(labels.matrix().data(),
               sizeof(float) * std::size_t(labels.matrix().size()));
  }
  for (const cv::Mat& truth : truths_)
    addTo(digest, truth);
  if (!folders_.calibration.empty()) {
    const std::vector<std::uint8_t> bytes = readBytes(folders_.calibration);
    digest.add(bytes.data(), bytes.size());
  }
  return digest.value();
}

std::string
TuningSequence::describe() const
{
  const auto have_truth =
      std::count_if(truths_.begin(), truths_.end(),
                    [](const cv::Mat& each) { return !each.empty(); });
  std::ostringstream text;
  text << fs::absolute(folders_.sequence).lexically_normal().string() << ", "
       << frames_.size() << " frames, " << have_truth << " with truth of "
       << fs::absolute(folders_.truth).lexically_normal().string() << ", labels of "
       << fs::absolute(folders_.labels).lexically_normal().string() << " (digest "
       << std::hex << digest_ << ")";
  return text.str();
}

std::unique_ptr<LabelPredictor>
TuningSequence::makePredictor(double png_confidence) const
{
  return std::make_unique<StoredPredictor>(folders_.labels, classes_,
                                           float(png_confidence));
}

std::unique_ptr<PoseSource>
TuningSequence::makePoses() const
{
  return std::make_unique<TrajectoryPoses>(trajectory_, sequence_.T_camera0_camera(),
                                           sequence_.posesPath());
}

std::shared_ptr<const std::vector<DisparityImage>>
TuningSequence::disparities(const MapperConfig& config) const
{
  const std::lock_guard<std::mutex> lock(computing_);
  auto& found = disparities_[{config.stereo, config.disparities}];
  if (!found) {
    const auto engine = makeDisparityEstimator(config.stereo, config.disparities);
    auto images = std::make_shared<std::vector<DisparityImage>>();
    for (const StereoFrame& frame : frames_)
      images->push_back(engine->estimate(frame.left, frame.right));
    found = images;
  }
  return found;
}

std::string
describeTuning(const std::vector<std::shared_ptr<const TuningSequence>>& sequences)
{
  std::ostringstream text;
  text << "program: pcl_semantic " << PCL_SEMANTIC_VERSION << " (digest " << std::hex
       << digestOfProgram() << ")\n";
  for (const auto& sequence : sequences)
    text << sequence->name() << ": " << sequence->describe() << "\n";
  return text.str();
}

} // namespace pcl_semantic
