// SPDX-License-Identifier: BSD-3-Clause
#include "circle_tracker.h"
#include "core/grey_image.h"
#include "keyframe_window.h"
#include "pose_ransac.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/odometry/stereo_odometry.h>

#include <algorithm>

namespace pcl_semantic {

/** \brief The work behind StereoOdometry; its own world is the first frame's left
 * camera ("first"). */
class StereoOdometry::Engine {
public:
  Engine(const StereoCamera& camera, const Eigen::Isometry3d& T_camera0_camera,
         const Parameters& parameters);

  const OdometryResult& process(const StereoFrame& frame);

  const OdometryResult&
  result() const
  {
    return result_;
  }

  int
  lostFrames() const
  {
    return lost_frames_;
  }

private:
  void takeImages(const StereoFrame& frame);

  void measureStep(const StereoFrame& frame);

  bool findPose();

  bool tryFrom(const Eigen::Isometry3d& guess);

  int followTracks(const Eigen::Isometry3d& guess,
                   std::vector<odometry::StereoFeature>& now) const;

  void continueFrom(const Eigen::Isometry3d& T_camera_before);

  void restart();

  void addMotion(const Eigen::Isometry3d& motion,
                 const odometry::Matrix6d& motion_covariance);

  void addTracks();

  Parameters parameters_;
  StereoCamera camera_;
  Eigen::Isometry3d T_world_first_;
  odometry::MeasurementNoise noise_;
  odometry::CircleTracker tracker_;
  odometry::KeyframeWindow window_;
  Eigen::Isometry3d T_camera_first_ = Eigen::Isometry3d::Identity(); ///< newest frame
  odometry::Vector6d velocity_ = odometry::Vector6d::Zero(); ///< a second, see log
  double timestamp_ = 0.0;
  double step_ = 0.0; ///< time since the frame before [s]
  int count_ = 0;     ///< frames so far
  int lost_frames_ = 0;
  bool knows_velocity_ = false; ///< measured, so that it predicts
  OdometryResult result_;
};

using namespace odometry;

namespace {

constexpr double kUsualStep = 0.1;      // where times do not tell [s]
constexpr double kMinInlierRatio = 0.3; // of the tracks that have to agree with a pose
constexpr double kMinDisparity = 0.01;  // of a point at infinity [px]

Eigen::Vector3d
measurementOf(const StereoFeature& feature)
{
  return {feature.left.x, feature.left.y, double(feature.left.x) - feature.right.x};
}

// How wrong a predicted motion may be: half of it, and a little more.
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
  window_.offset_deviation = std::max(parameters.offset_drift, 1e-9);
}

const OdometryResult&
StereoOdometry::Engine::process(const StereoFrame& frame)
{
  if (count_ > 0 && frame.number == result_.frame)
    return result_;
  takeImages(frame);
  measureStep(frame);
  const Eigen::Isometry3d T_camera_before = T_camera_first_;
  T_camera_first_ = expMotion(velocity_ * step_) * T_camera_first_;
  result_.frame = frame.number;
  result_.tracked = result_.inliers = 0;
  result_.is_keyframe = true;
  window_.frames.push_back({count_, T_camera_first_});
  result_.is_lost = count_ > 0 && !findPose();
  if (count_ == 0)
    addTracks();
  else if (result_.is_lost)
    restart();
  else
    continueFrom(T_camera_before);
  result_.T_world_camera = T_world_first_ * T_camera_first_.inverse();
  result_.disparity_offset = window_.offset;
  ++count_;
  return result_;
}

void
StereoOdometry::Engine::takeImages(const StereoFrame& frame)
{
  const cv::Mat &left = frame.left, &right = frame.right;
  if (left.empty() || left.size() != right.size() || left.type() != right.type())
    PCL_THROW_EXCEPTION(BadInputException,
                        "frame " << frame.number << ": the left image has " << left.cols
                                 << " x " << left.rows << " pixels, the right one "
                                 << right.cols << " x " << right.rows
                                 << ", expected two of one size and type");
  if (left.type() != CV_8UC1 && left.type() != CV_8UC3)
    PCL_THROW_EXCEPTION(BadInputException,
                        "frame " << frame.number
                                 << ": the images are neither grey nor BGR of 8 bits");
  if ((camera_.width > 0 && left.cols != camera_.width) ||
      (camera_.height > 0 && left.rows != camera_.height))
    PCL_THROW_EXCEPTION(BadInputException,
                        "frame " << frame.number << ": the images have " << left.cols
                                 << " x " << left.rows << " pixels, expected "
                                 << camera_.width << " x " << camera_.height);
  camera_.width = left.cols; // the next frames' size, where it was not known
  camera_.height = left.rows;
  tracker_.push(greyImage(left), greyImage(right));
}

void
StereoOdometry::Engine::measureStep(const StereoFrame& frame)
{
  const double passed = frame.timestamp - timestamp_;
  step_ = passed > 0.0 && std::isfinite(passed) ? passed : kUsualStep;
  timestamp_ = frame.timestamp;
}

// From the predicted pose; where that leads nowhere from standing still; and once more
// from what was found where nothing could be predicted.
bool
StereoOdometry::Engine::findPose()
{
  bool is_found = tryFrom(T_camera_first_);
  if (!is_found && knows_velocity_)
    is_found = tryFrom(window_.frames[window_.frames.size() - 2].T_camera_world);
  if (is_found && !knows_velocity_)
    tryFrom(window_.frames.back().T_camera_world);
  return is_found;
}

int
StereoOdometry::Engine::followTracks(const Eigen::Isometry3d& guess,
                                     std::vector<StereoFeature>& now) const
{
  std::vector<StereoFeature> before;
  now.clear();
  for (const FeatureTrack& track : window_.tracks) {
    if (!track.is_alive)
      continue;
    before.push_back(track.now);
    now.push_back(track.now);
    const AnchoredPoint point = track.inWorld();
    const Eigen::Vector3d q = scaledPoint(point, guess);
    if (q.z() < 1e-3)
      continue;
    const Eigen::Vector3d uvd = projectStereo(camera_, q, point.inverse_depth);
    now.back().left = {float(uvd.x()), float(uvd.y())};
    now.back().right = {float(uvd.x() - uvd.z() - window_.offset), float(uvd.y())};
  }
  tracker_.track(before, now);
  return int(std::count_if(now.begin(), now.end(),
                           [](const StereoFeature& each) { return each.is_found; }));
}

// Follows all tracks and finds the pose they agree on; nothing changes without one, nor
// with one that fewer agree on than with the one there is.
bool
StereoOdometry::Engine::tryFrom(const Eigen::Isometry3d& guess)
{
  std::vector<StereoFeature> now;
  const int tracked = followTracks(guess, now);
  std::vector<PoseMeasurement> measurements;
  std::size_t next = 0;
  for (const FeatureTrack& track : window_.tracks) {
    if (!track.is_alive || !now[next++].is_found)
      continue;
    measurements.push_back({track.inWorld(), measurementOf(now[next - 1])});
    measurements.back().uvd.z() -= window_.offset;
  }
  Eigen::Isometry3d pose = guess;
  const std::vector<char> inliers =
      PoseRansac(camera_, noise_).estimate(measurements, pose);
  const int agreeing = int(std::count(inliers.begin(), inliers.end(), 1));
  result_.tracked = std::max(result_.tracked, tracked);
  if (agreeing < parameters_.minimum_inliers || agreeing < kMinInlierRatio * tracked ||
      agreeing < result_.inliers)
    return false;
  result_.inliers = agreeing;
  window_.frames.back().T_camera_world = pose;
  next = 0;
  std::size_t measured = 0;
  for (FeatureTrack& track : window_.tracks) {
    if (!track.is_alive)
      continue;
    track.next = now[next++];
    track.next.is_found = track.next.is_found && inliers[measured++];
  }
  return true;
}

// Pose and depths are adjusted over the window; the rest follows from them.
void
StereoOdometry::Engine::continueFrom(const Eigen::Isometry3d& T_camera_before)
{
  for (FeatureTrack& track : window_.tracks) {
    if (!track.is_alive)
      continue;
    track.is_alive = track.next.is_found;
    track.now = track.next;
    if (track.is_alive)
      track.sightings.push_back({count_, measurementOf(track.now)});
  }
  const Matrix6d covariance = window_.adjust(parameters_.iterations);
  T_camera_first_ = window_.frames.back().T_camera_world;
  const Eigen::Isometry3d motion = T_camera_first_ * T_camera_before.inverse();
  velocity_ = logMotion(motion) / step_;
  knows_velocity_ = true;
  addMotion(motion, covariance);
  result_.is_keyframe =
      window_.newestBringsMuch(parameters_.keyframe_flow * camera_.width);
  if (result_.is_keyframe) {
    addTracks();
    window_.shrink(std::size_t(parameters_.window));
  }
  else
    window_.dropNewest();
}

// The prediction is kept, and what comes is measured against it.
void
StereoOdometry::Engine::restart()
{
  ++lost_frames_;
  const Vector6d motion = velocity_ * step_;
  addMotion(expMotion(motion), covarianceOfPrediction(motion));
  knows_velocity_ = false;
  window_.frames.clear();
  window_.tracks.clear();
  window_.frames.push_back({count_, T_camera_first_});
  addTracks();
}

void
StereoOdometry::Engine::addMotion(const Eigen::Isometry3d& motion,
                                  const Matrix6d& motion_covariance)
{
  const Matrix6d A = adjoint(motion);
  result_.motion_covariance = motion_covariance;
  result_.covariance = A * result_.covariance * A.transpose() + motion_covariance;
}

void
StereoOdometry::Engine::addTracks()
{
  std::vector<cv::Point2f> old;
  for (const FeatureTrack& track : window_.tracks)
    if (track.is_alive)
      old.push_back(track.now.left);
  const int max_disparity =
      parameters_.max_disparity ? parameters_.max_disparity : tracker_.left().cols / 8;
  std::vector<StereoFeature> features;
  for (const cv::Point2f& corner :
       detectCorners(tracker_.left(), old, parameters_.features)) {
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

void
StereoOdometry::Parameters::validate() const
{
  const auto require = [](bool is_good, const char* name, double value,
                          const char* expected) {
    if (!is_good)
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          name << " is " << value << ", expected " << expected);
  };
  require(features >= 20 && features <= 100000, "features", features, "20 to 100000");
  require(window >= 2 && window <= 100, "window", window, "2 to 100");
  require(iterations >= 1 && iterations <= 1000, "iterations", iterations, "1 to 1000");
  require(minimum_inliers >= 6, "minimum_inliers", minimum_inliers, "6 or more");
  require(max_disparity >= 0 && max_disparity <= 4096, "max_disparity", max_disparity,
          "0 to 4096 px");
  require(keyframe_flow >= 0.0 && keyframe_flow <= 1.0, "keyframe_flow", keyframe_flow,
          "0 to 1");
  require(pixel_noise > 0.0 && pixel_noise <= 100.0, "pixel_noise", pixel_noise,
          "more than 0 and at most 100 px");
  require(disparity_noise > 0.0 && disparity_noise <= 100.0, "disparity_noise",
          disparity_noise, "more than 0 and at most 100 px");
  require(offset_drift >= 0.0 && offset_drift <= 100.0, "offset_drift", offset_drift,
          "0 to 100 px");
}

StereoOdometry::StereoOdometry(const StereoCamera& camera,
                               const Eigen::Isometry3d& T_camera0_camera,
                               const Parameters& parameters)
    : engine_(std::make_unique<Engine>(camera, T_camera0_camera, parameters))
{}

StereoOdometry::StereoOdometry(const StereoCamera& camera,
                               const Eigen::Isometry3d& T_camera0_camera)
    : StereoOdometry(camera, T_camera0_camera, Parameters())
{}

StereoOdometry::~StereoOdometry() = default;

Eigen::Isometry3d
StereoOdometry::pose(const SensorFrame& frame)
{
  const auto* const pair = std::get_if<StereoFrame>(&frame);
  if (!pair)
    PCL_THROW_EXCEPTION(BadInputException,
                        "frame " << timeOf(frame).number
                                 << " is a cloud; odometry needs a stereo pair");
  return process(*pair).T_world_camera;
}

const OdometryResult&
StereoOdometry::process(const StereoFrame& frame)
{
  return engine_->process(frame);
}

const OdometryResult&
StereoOdometry::result() const
{
  return engine_->result();
}

int
StereoOdometry::lostFrames() const
{
  return engine_->lostFrames();
}

} // namespace pcl_semantic
