/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "odometry_engine.h"

#include "corner_detector.h"
#include "epipolar_search.h"
#include "pose_ransac.h"

#include <pcl_semantic/core/exceptions.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>

namespace pcl_semantic {

using namespace odometry;

namespace {

constexpr double kUsualStep = 0.1; // [s] where times do not tell

Eigen::Vector3d
measurementOf(const StereoFeature& feature)
{
  return {feature.left.x, feature.left.y, double(feature.left.x) - feature.right.x};
}

cv::Mat
toGrey(const cv::Mat& image)
{
  if (image.channels() == 1)
    return image;
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

} // namespace

StereoOdometry::Engine::Engine(const StereoCamera& camera,
                               const Eigen::Isometry3d& T_camera0_camera,
                               const Parameters& parameters)
    : parameters_(parameters), camera_(camera),
      T_world_first_(worldFromFirstCamera() * T_camera0_camera),
      noise_{parameters.pixel_noise, parameters.disparity_noise},
      window_(camera, noise_)
{
  camera.validate();
  parameters.validate();
}

const OdometryResult&
StereoOdometry::Engine::process(const StereoFrame& frame)
{
  if (count_ > 0 && frame.number == result_.frame)
    return result_;
  const double passed = frame.timestamp - timestamp_;
  step_ = passed > 0.0 && std::isfinite(passed) ? passed : kUsualStep;
  timestamp_ = frame.timestamp;
  tracker_.push(toGrey(frame.left), toGrey(frame.right));

  const Eigen::Isometry3d T_camera_before = T_camera_first_;
  T_camera_first_ = expMotion(velocity_ * step_) * T_camera_first_;
  result_.frame = frame.number;
  result_.tracked = result_.inliers = 0;
  window_.frames.push_back({count_, T_camera_first_});
  bool is_found = count_ == 0;
  if (count_ > 0) {
    followTracks();
    is_found = estimatePose();
  }
  finishFrame(is_found, T_camera_before);
  ++count_;
  return result_;
}

// From where they were to where the predicted pose sees them.
void
StereoOdometry::Engine::followTracks()
{
  std::vector<FeatureTrack*> alive;
  std::vector<StereoFeature> before, now;
  for (FeatureTrack& track : window_.tracks) {
    if (!track.is_alive)
      continue;
    alive.push_back(&track);
    before.push_back(track.now);
    now.push_back(track.now);
    const AnchoredPoint point = track.inWorld();
    const Eigen::Vector3d q = scaledPoint(point, T_camera_first_);
    if (q.z() < 1e-3)
      continue;
    const Eigen::Vector3d uvd = projectStereo(camera_, q, point.inverse_depth);
    now.back().left = {float(uvd.x()), float(uvd.y())};
    now.back().right = {float(uvd.x() - uvd.z()), float(uvd.y())};
  }
  tracker_.track(before, now);
  for (std::size_t i = 0; i < alive.size(); ++i) {
    alive[i]->now = now[i];
    alive[i]->is_alive = now[i].is_found;
    result_.tracked += now[i].is_found;
  }
}

bool
StereoOdometry::Engine::estimatePose()
{
  std::vector<PoseMeasurement> measurements;
  std::vector<FeatureTrack*> alive;
  for (FeatureTrack& track : window_.tracks)
    if (track.is_alive) {
      measurements.push_back({track.inWorld(), measurementOf(track.now)});
      alive.push_back(&track);
    }
  Eigen::Isometry3d T_camera_first = T_camera_first_;
  const std::vector<char> inliers =
      PoseRansac(camera_, noise_).estimate(measurements, T_camera_first);
  const int agreeing = int(std::count(inliers.begin(), inliers.end(), 1));
  if (agreeing < parameters_.minimum_inliers || agreeing < 0.3 * double(alive.size()))
    return false;
  for (std::size_t i = 0; i < alive.size(); ++i) {
    alive[i]->is_alive = inliers[i];
    if (inliers[i])
      alive[i]->sightings.push_back({count_, measurements[i].uvd});
  }
  result_.inliers = agreeing;
  window_.frames.back().T_camera_world = T_camera_first;
  return true;
}

void
StereoOdometry::Engine::finishFrame(bool is_found,
                                    const Eigen::Isometry3d& T_camera_before)
{
  Matrix6d covariance = Matrix6d::Zero();
  if (is_found && count_ > 0) {
    covariance = window_.adjust(parameters_.iterations);
    T_camera_first_ = window_.frames.back().T_camera_world;
    velocity_ = logMotion(T_camera_first_ * T_camera_before.inverse()) / step_;
  }
  if (!is_found) {
    ++lost_;
    window_.clear();
    window_.frames.push_back({count_, T_camera_first_});
  }
  result_.is_lost = !is_found;
  result_.is_keyframe = !is_found || count_ == 0 || wantsKeyframe();
  if (result_.is_keyframe) {
    addTracks();
    window_.shrink(std::size_t(parameters_.window));
  }
  else
    window_.dropNewest();
  result_.T_world_camera = T_world_first_ * T_camera_first_.inverse();
  result_.motion_covariance = covariance;
}

bool
StereoOdometry::Engine::wantsKeyframe() const
{
  return true;
}

void
StereoOdometry::Engine::addTracks()
{
  std::vector<cv::Point2f> old;
  for (const FeatureTrack& track : window_.tracks)
    if (track.is_alive)
      old.push_back(track.now.left);
  const std::vector<cv::Point2f> corners =
      detectCorners(tracker_.left(), old, parameters_.features);
  const int max_disparity = parameters_.max_disparity ? parameters_.max_disparity
                                                      : tracker_.left().cols / 8;
  std::vector<StereoFeature> features;
  for (const cv::Point2f& corner : corners) {
    const int disparity =
        searchDisparity(tracker_.left(), tracker_.right(), corner, max_disparity);
    if (disparity >= 0)
      features.push_back({corner, {corner.x - float(disparity), corner.y}, false});
  }
  tracker_.matchStereo(features);
  for (const StereoFeature& feature : features) {
    if (!feature.is_found)
      continue;
    FeatureTrack track;
    const Eigen::Vector3d uvd = measurementOf(feature);
    track.place.ray = camera_.unproject(uvd.x(), uvd.y(), 1.0);
    track.place.inverse_depth =
        std::max(uvd.z(), 0.01) / (camera_.fx * camera_.baseline);
    track.anchor = count_;
    track.T_world_anchor = T_camera_first_.inverse();
    track.anchor_disparity = uvd.z();
    track.now = feature;
    window_.tracks.push_back(track);
  }
}

} // namespace pcl_semantic
