// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/rgbd_sequence.h>

#include "core/fail.h"
#include "files/is_there.h"
#include "rgbd_layout.h"
#include "rgbd_reader.h"

#include <pcl_semantic/core/camera_doubts.h>
#include <pcl_semantic/images/image_file.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

namespace pcl_semantic {

namespace {

// Median of the measured depths [m].
std::optional<double>
medianOf(const cv::Mat1d& depths)
{
  std::vector<double> measured;
  std::copy_if(depths.begin(), depths.end(), std::back_inserter(measured),
               [](double depth) { return std::isfinite(depth); });
  if (measured.empty())
    return std::nullopt;
  const auto middle = measured.begin() + std::ptrdiff_t(measured.size() / 2);
  std::nth_element(measured.begin(), middle, measured.end());
  return *middle;
}

// Checks the median depth: in rooms and streets it is within these limits.
std::string
doubtOfScale(double depth, double scale)
{
  constexpr double nearest = 0.05, farthest = 100.0; // [m]
  if (depth >= nearest && depth <= farthest)
    return {};
  TextStream text;
  text << "half of its depths are " << (depth < nearest ? "less" : "more") << " than "
       << depth << " m with depth scale " << scale;
  const auto isLikely = [&](double other) {
    return depth * scale / other >= 0.3 && depth * scale / other <= 50.0;
  };
  for (const double other : {1000.0, 5000.0, 256.0, 10000.0, 100.0, 1.0})
    if (isLikely(other)) {
      text << "; " << other << " would give " << depth * scale / other << " m";
      break;
    }
  return text.str();
}

} // namespace

void
RgbdFiles::requireCamera(const std::string& calibration) const
{
  if (calibration.empty() == intrinsics.empty())
    badParameter("--rgbd needs --calibration or --intrinsics, the camera");
  if (calibration.empty())
    pinholeCameraOf("", intrinsics);
}

ConfigParameters
parametersOf(RgbdFiles& files)
{
  return {
      {"rgbd",
       "RGB-D sequence instead of SEQUENCE: a folder with rgb/ and depth/, or in the "
       "layout of TUM or 7-Scenes; needs --calibration (ROS camera_info, Kalibr) or "
       "--intrinsics",
       &files.folder},
      {"intrinsics", "intrinsics fx,fy,cx,cy of --rgbd instead of --calibration [px]",
       &files.intrinsics},
      {"depth_scale",
       "value of 1 m in the depth images of --rgbd; 0 = 5000 in TUM's layout, 1 for "
       "float images, else 1000",
       &files.depth_scale},
      {"depth_within",
       "maximum difference between the times of a colour image and its depth image "
       "in TUM's layout [s]",
       &files.depth_within}};
}

RgbdSequence::RgbdSequence(const RgbdFiles& files, const std::string& calibration)
    : RgbdSequence(files.folder, pinholeCameraOf(calibration, files.intrinsics),
                   files.depth_scale, files.depth_within)
{}

RgbdSequence::RgbdSequence(const std::string& folder, const PinholeCamera& camera,
                           double depth_scale, double depth_within)
    : RgbdSequence(folder, depth_scale, depth_within)
{
  camera.validate();
  doubts_.insert(doubts_.begin(), camera.doubts.begin(), camera.doubts.end());
  const std::string& first = frames_.front().colour;
  const cv::Mat image = readImage(first);
  undistorter_.emplace(camera, image.cols, image.rows, first);
}

RgbdSequence::RgbdSequence(const std::string& folder, double depth_scale,
                           double depth_within)
    : depth_scale_(depth_scale)
{
  DepthScale{depth_scale}.validate();
  if (!(depth_within >= 0.0 && std::isfinite(depth_within)))
    badParameter("depth_within is ", depth_within, " s, expected 0 or more");
  RgbdLayout layout = rgbdLayoutOf(folder, depth_within);
  is_tum_ = layout.is_tum;
  has_times_ = layout.has_times;
  poses_ = std::move(layout.poses);
  pose_frame_ = layout.pose_frame;
  doubts_ = std::move(layout.doubts);
  for (RgbdLayout::Files& files : layout.frames)
    frames_.push_back({std::move(files.name), std::move(files.colour),
                       std::move(files.depth), std::move(files.pose), files.time,
                       files.number});
}

std::map<int, std::string>
RgbdSequence::colourImages(const std::string& folder, double depth_within,
                           std::vector<std::string>* doubts)
{
  const RgbdSequence sequence(folder, 0.0, depth_within);
  std::map<int, std::string> paths;
  for (const Files& files : sequence.frames_)
    paths[files.number] = files.colour;
  if (doubts)
    doubts->insert(doubts->end(), sequence.doubts_.begin(), sequence.doubts_.end());
  return paths;
}

bool
RgbdSequence::hasPoseFiles() const
{
  return isFolder(poses_);
}

StoredTrajectory
RgbdSequence::takePoseFiles()
{
  StoredTrajectory read{poses_, pose_frame_, TrajectoryFormat::kitti, {}, {}};
  TimedPose lost;
  lost.pose.matrix().setConstant(std::numeric_limits<double>::quiet_NaN());
  read.poses.assign(std::size_t(frames_.back().number) + 1, lost);
  Trajectory known;
  std::vector<Files> kept;
  for (Files& files : frames_) {
    if (!isThere(files.pose))
      badInput(files.pose, ": is missing, the pose of ", files.colour,
               "; --poses gives another trajectory");
    const Eigen::Isometry3d pose = readPoseFile(files.pose, &read.doubts);
    read.poses[std::size_t(files.number)].pose = pose;
    if (!pose.matrix().allFinite())
      continue;
    known.push_back(pose);
    kept.push_back(std::move(files));
  }
  if (kept.empty())
    badInput(poses_, ": no frame has a finite pose");
  if (kept.size() < frames_.size())
    read.doubts.push_back(poses_ + ": " + std::to_string(frames_.size() - kept.size()) +
                          " of " + std::to_string(frames_.size()) +
                          " frames have no finite pose and are skipped");
  for (const std::string& doubt : doubtsOf(known, pose_frame_, false))
    read.doubts.push_back(poses_ + ": " + doubt);
  frames_ = std::move(kept);
  return read;
}

std::vector<std::string>
RgbdSequence::doubts() const
{
  std::vector<std::string> doubts = doubts_;
  for (std::string& doubt : doubtsOf(camera()))
    doubts.push_back(std::move(doubt));
  for (const Files& files : frames_) {
    const cv::Mat image = readDepthImage(files.depth);
    const double scale = DepthScale{depth_scale_, is_tum_}.of(image);
    if (const auto median = medianOf(depthsInMetres(image, scale))) {
      const std::string doubt = doubtOfScale(*median, scale);
      if (!doubt.empty())
        doubts.push_back(files.depth + ": " + doubt);
      break;
    }
  }
  return doubts;
}

RgbdFrame
RgbdSequence::frame(std::size_t i, double max_depth) const
{
  if (i >= frames_.size())
    badParameter("frame ", i, " is beyond the ", frames_.size(), " of the sequence");
  if (!(max_depth >= 0.0))
    badParameter("max_depth is ", max_depth, " m, expected 0 (unlimited) or more");
  const Files& files = frames_[i];
  RgbdFrame frame =
      readRgbdFrame(files.colour, files.depth, *undistorter_, {depth_scale_, is_tum_},
                    max_depth, frames_.front().colour);
  frame.number = files.number;
  frame.timestamp = files.time;
  return frame;
}

} // namespace pcl_semantic
