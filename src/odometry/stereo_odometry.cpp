// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/odometry/stereo_odometry.h>

#include "circle_tracker.h"
#include "core/fail.h"
#include "corners.h"
#include "depth_tracker.h"
#include "images/grey_image.h"
#include "keyframe_window.h"
#include "pose_ransac.h"

#include <pcl_semantic/core/sensor_pose.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace pcl_semantic {

using namespace odometry;

namespace {

constexpr double kUsualStep = 0.1;      // without timestamps [s]
constexpr double kMinInlierRatio = 0.3; // of the tracks, for a valid pose
constexpr double kMinDisparity = 0.01;  // of a point at infinity [px]

Eigen::Vector3d
measurementOf(const StereoFeature& feature)
{
  return {feature.left.x, feature.left.y, double(feature.left.x) - feature.right.x};
}

// Standard deviation: half of the predicted motion, plus a small constant.
Matrix6d
covarianceOfPrediction(const Vector6d& motion)
{
  const double way = 0.5 * motion.head<3>().norm() + 0.1;
  const double angle = 0.5 * motion.tail<3>().norm() + 0.02;
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(way * way),
      Eigen::Vector3d::Constant(angle * angle);
  return variance.asDiagonal();
}

} // namespace

/** \brief Implementation of StereoOdometry; its world is the first frame's left camera
 * ("first"). */
class StereoOdometry::Engine {
public:
  Engine(const StereoCamera& camera, const Eigen::Isometry3d& T_camera0_camera,
         const Parameters& parameters)
      : parameters_(parameters), camera_(camera),
        T_world_first_(worldFromFirstCamera() * T_camera0_camera),
        noise_{parameters.pixel_noise, parameters.disparity_noise},
        window_(camera, noise_)
  {
    camera.validate();
    parameters.validate();
    window_.offset_deviation = std::max(parameters.offset_drift, 1e-9);
  }

  template <typename Frame>
  const OdometryResult&
  process(const Frame& frame)
  {
    if (count_ > 0 && frame.number == result.frame)
      return result;
    takeImages(frame);
    measureStep(frame);
    const Eigen::Isometry3d T_camera_before = T_camera_first_;
    T_camera_first_ = expMotion(velocity_ * step_) * T_camera_first_;
    result.frame = frame.number;
    result.tracked = result.inliers = 0;
    result.is_keyframe = true;
    window_.frames.push_back({count_, T_camera_first_});
    result.is_lost = count_ > 0 && !findPose();
    if (count_ == 0)
      addTracks();
    else if (result.is_lost)
      restart();
    else
      continueFrom(T_camera_before);
    result.T_world_camera = T_world_first_ * T_camera_first_.inverse();
    result.disparity_offset = window_.offset;
    ++count_;
    return result;
  }

  OdometryResult result; ///< of the last frame
  int lost_frames = 0;

private:
  void
  takeImages(const StereoFrame& frame)
  {
    const cv::Mat &left = frame.left, &right = frame.right;
    if (left.empty() || left.size() != right.size() || left.type() != right.type())
      badInput("frame ", frame.number, ": the left image has ", left.cols, " x ",
               left.rows, " pixels, the right one ", right.cols, " x ", right.rows,
               ", expected two of one size and type");
    takeSize(left, frame.number);
    takeTracker(pairs_, frame.number);
    pairs_.push(greyImage(left), greyImage(right));
  }

  void
  takeImages(const RgbdFrame& frame)
  {
    const cv::Mat& image = frame.image;
    if (image.empty() || !frame.cloud || int(frame.cloud->width) != image.cols ||
        int(frame.cloud->height) != image.rows)
      badInput("frame ", frame.number, ": the image has ", image.cols, " x ",
               image.rows, " pixels, expected those of its depths");
    takeSize(image, frame.number);
    takeTracker(depths_, frame.number);
    cv::Mat1f disparities(image.rows, image.cols);
    for (int v = 0; v < image.rows; ++v)
      for (int u = 0; u < image.cols; ++u) {
        const float depth = (*frame.cloud)(u, v).z;
        disparities(v, u) = // 0 for NaN
            depth > 0.0f ? float(camera_.fx * camera_.baseline / double(depth)) : 0.0f;
      }
    depths_.push(greyImage(image), disparities);
  }

  void
  takeSize(const cv::Mat& image, int frame)
  {
    if (image.type() != CV_8UC1 && image.type() != CV_8UC3)
      badInput("frame ", frame, ": the images are neither grey nor BGR of 8 bits");
    if ((camera_.width > 0 && image.cols != camera_.width) ||
        (camera_.height > 0 && image.rows != camera_.height))
      badInput("frame ", frame, ": the images have ", image.cols, " x ", image.rows,
               " pixels, expected ", camera_.width, " x ", camera_.height);
    camera_.width = image.cols; // size of the next frames, if it was unknown
    camera_.height = image.rows;
  }

  void
  takeTracker(FeatureTracker& tracker, int frame)
  {
    if (tracker_ && tracker_ != &tracker)
      badInput("frame ", frame,
               ": expected the kind of the frames before it, stereo or RGB-D");
    tracker_ = &tracker;
  }

  void
  measureStep(const FrameTime& frame)
  {
    const double passed = frame.timestamp - timestamp_;
    step_ = passed > 0.0 && std::isfinite(passed) ? passed : kUsualStep;
    timestamp_ = frame.timestamp;
  }

  // Starts from the predicted pose and, if that fails, from the previous pose. Without
  // a prediction, the result is the start of a second attempt.
  bool
  findPose()
  {
    bool is_found = tryFrom(T_camera_first_);
    if (!is_found && knows_velocity_)
      is_found = tryFrom(window_.frames[window_.frames.size() - 2].T_camera_world);
    if (is_found && !knows_velocity_)
      tryFrom(window_.frames.back().T_camera_world);
    return is_found;
  }

  std::vector<FeatureTrack*>
  aliveTracks()
  {
    std::vector<FeatureTrack*> alive;
    for (FeatureTrack& track : window_.tracks)
      if (track.is_alive)
        alive.push_back(&track);
    return alive;
  }

  // Current positions of the features of tracks, given an approximate pose.
  std::vector<StereoFeature>
  follow(const std::vector<FeatureTrack*>& tracks, const Eigen::Isometry3d& guess) const
  {
    std::vector<StereoFeature> before;
    for (const FeatureTrack* const track : tracks)
      before.push_back(track->now);
    std::vector<StereoFeature> now = before;
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      const AnchoredPoint point = tracks[i]->inWorld();
      const Eigen::Vector3d q = scaledPoint(point, guess);
      if (q.z() < 1e-3)
        continue;
      const Eigen::Vector3d uvd = projectStereo(camera_, q, point.inverse_depth);
      now[i].left = {float(uvd.x()), float(uvd.y())};
      now[i].right = {float(uvd.x() - uvd.z() - window_.offset), float(uvd.y())};
    }
    tracker_->track(before, now);
    return now;
  }

  // Tracks all features and estimates the pose. Nothing changes if this fails, or if
  // the current estimate has more inliers.
  bool
  tryFrom(const Eigen::Isometry3d& guess)
  {
    const std::vector<FeatureTrack*> tracks = aliveTracks();
    const std::vector<StereoFeature> now = follow(tracks, guess);
    std::vector<PoseMeasurement> measurements;
    for (std::size_t i = 0; i < tracks.size(); ++i)
      if (now[i].is_found) {
        measurements.push_back({tracks[i]->inWorld(), measurementOf(now[i])});
        measurements.back().uvd.z() -= window_.offset;
      }
    Eigen::Isometry3d pose = guess;
    const std::vector<char> inliers = estimatePose(camera_, noise_, measurements, pose);
    const int tracked = int(measurements.size());
    const int agreeing = int(std::count(inliers.begin(), inliers.end(), 1));
    result.tracked = std::max(result.tracked, tracked);
    if (agreeing < parameters_.minimum_inliers ||
        agreeing < kMinInlierRatio * tracked || agreeing < result.inliers)
      return false;
    result.inliers = agreeing;
    window_.frames.back().T_camera_world = pose;
    auto agrees = inliers.begin();
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      tracks[i]->next = now[i];
      tracks[i]->next.is_found = now[i].is_found && *agrees++;
    }
    return true;
  }

  // Adjusts poses and depths of the window and updates the result.
  void
  continueFrom(const Eigen::Isometry3d& T_camera_before)
  {
    for (FeatureTrack* const track : aliveTracks()) {
      track->is_alive = track->next.is_found;
      track->now = track->next;
      if (track->is_alive)
        track->sightings.push_back({count_, measurementOf(track->now)});
    }
    const Matrix6d covariance = window_.adjust(parameters_.iterations);
    T_camera_first_ = window_.frames.back().T_camera_world;
    const Eigen::Isometry3d motion = T_camera_first_ * T_camera_before.inverse();
    velocity_ = logMotion(motion) / step_;
    knows_velocity_ = true;
    addMotion(motion, covariance);
    result.is_keyframe =
        window_.newestBringsMuch(parameters_.keyframe_flow * camera_.width);
    if (result.is_keyframe) {
      addTracks();
      window_.shrink(std::size_t(parameters_.window));
    }
    else
      window_.dropNewest();
  }

  // Keeps the prediction and continues relative to it.
  void
  restart()
  {
    ++lost_frames;
    const Vector6d motion = velocity_ * step_;
    addMotion(expMotion(motion), covarianceOfPrediction(motion));
    knows_velocity_ = false;
    window_.frames.clear();
    window_.tracks.clear();
    window_.frames.push_back({count_, T_camera_first_});
    addTracks();
  }

  void
  addMotion(const Eigen::Isometry3d& motion, const Matrix6d& motion_covariance)
  {
    const Matrix6d A = adjoint(motion);
    result.motion_covariance = motion_covariance;
    result.covariance = A * result.covariance * A.transpose() + motion_covariance;
  }

  void
  addTracks()
  {
    std::vector<cv::Point2f> old;
    for (const FeatureTrack* const track : aliveTracks())
      old.push_back(track->now.left);
    const int max_disparity = parameters_.max_disparity ? parameters_.max_disparity
                                                        : tracker_->image().cols / 8;
    for (const StereoFeature& feature : tracker_->featuresAt(
             detectCorners(tracker_->image(), old, parameters_.features),
             max_disparity)) {
      FeatureTrack track;
      const Eigen::Vector3d uvd = measurementOf(feature);
      track.position.ray = camera_.unproject(uvd.x(), uvd.y(), 1.0);
      track.position.inverse_depth = std::max(uvd.z() - window_.offset, kMinDisparity) /
                                     (camera_.fx * camera_.baseline);
      track.anchor = count_;
      track.T_world_anchor = T_camera_first_.inverse();
      track.anchor_disparity = uvd.z();
      track.now = feature;
      window_.tracks.push_back(track);
    }
  }

  Parameters parameters_;
  StereoCamera camera_;
  Eigen::Isometry3d T_world_first_;
  MeasurementNoise noise_;
  CircleTracker pairs_;
  DepthTracker depths_;
  FeatureTracker* tracker_ = nullptr; // one of them, after the first frame
  KeyframeWindow window_;
  Eigen::Isometry3d T_camera_first_ = Eigen::Isometry3d::Identity(); ///< newest frame
  Vector6d velocity_ = Vector6d::Zero(); ///< per second, see logMotion()
  double timestamp_ = 0.0;
  double step_ = 0.0;           ///< time since the previous frame [s]
  int count_ = 0;               ///< frames so far
  bool knows_velocity_ = false; ///< a measured velocity is available for prediction
};

void
StereoOdometry::Parameters::validate() const
{
  constexpr double most = std::numeric_limits<double>::max();
  constexpr double positive = std::numeric_limits<double>::denorm_min();
  const std::tuple<const char*, double, double, double, const char*> ranges[] = {
      {"features", features, 20, 100000, "20 to 100000"},
      {"window", window, 2, 100, "2 to 100"},
      {"iterations", iterations, 1, 1000, "1 to 1000"},
      {"minimum_inliers", minimum_inliers, 6, most, "6 or more"},
      {"max_disparity", max_disparity, 0, 4096, "0 to 4096 px"},
      {"keyframe_flow", keyframe_flow, 0, 1, "0 to 1"},
      {"pixel_noise", pixel_noise, positive, 100, "more than 0 and at most 100 px"},
      {"disparity_noise", disparity_noise, positive, 100,
       "more than 0 and at most 100 px"},
      {"offset_drift", offset_drift, 0, 100, "0 to 100 px"}};
  for (const auto& [name, value, min, max, expected] : ranges)
    if (!(value >= min && value <= max))
      badParameter(name, " is ", value, ", expected ", expected);
}

StereoOdometry::StereoOdometry(const StereoCamera& camera,
                               const Eigen::Isometry3d& T_camera0_camera,
                               const Parameters& parameters)
    : engine_(std::make_unique<Engine>(camera, T_camera0_camera, parameters))
{
  requireRigid(T_camera0_camera, "odometry: the pose of the camera in camera 0");
}

StereoOdometry::StereoOdometry(const StereoCamera& camera,
                               const Eigen::Isometry3d& T_camera0_camera)
    : StereoOdometry(camera, T_camera0_camera, Parameters())
{}

StereoOdometry::~StereoOdometry() = default;

Eigen::Isometry3d
StereoOdometry::pose(const SensorFrame& frame)
{
  if (const auto* const rgbd = std::get_if<RgbdFrame>(&frame))
    return process(*rgbd).T_world_camera;
  const auto* const pair = std::get_if<StereoFrame>(&frame);
  if (!pair)
    badInput("frame ", timeOf(frame).number,
             " is a cloud; odometry needs a stereo pair or an RGB-D frame");
  return process(*pair).T_world_camera;
}

StereoOdometry::Parameters
StereoOdometry::parametersOfDepths()
{
  Parameters parameters;
  parameters.disparity_noise = 0.1;
  parameters.offset_drift = 0.0;
  return parameters;
}

StereoCamera
StereoOdometry::cameraOfDepths(StereoCamera camera)
{
  camera.baseline = 0.075;
  return camera;
}

const OdometryResult&
StereoOdometry::process(const RgbdFrame& frame)
{
  return engine_->process(frame);
}

const OdometryResult&
StereoOdometry::process(const StereoFrame& frame)
{
  return engine_->process(frame);
}

const OdometryResult&
StereoOdometry::result() const
{
  return engine_->result;
}

int
StereoOdometry::lostFrames() const
{
  return engine_->lost_frames;
}

} // namespace pcl_semantic
