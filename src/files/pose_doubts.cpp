// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/pose_doubts.h>

#include "core/text_stream.h"

#include <pcl_semantic/core/sensor_pose.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

// Cosine between the sensor's up axis and the world's, for each pose.
using Uprights = std::vector<double>;

double
meanOf(const Uprights& uprights)
{
  double sum = 0.0;
  for (const double each : uprights)
    sum += each;
  return sum / double(uprights.size());
}

double
medianOf(std::vector<double> values)
{
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Fraction of poses that are tilted by less than 60 degrees.
double
uprightFraction(const Uprights& uprights)
{
  return double(std::count_if(uprights.begin(), uprights.end(),
                              [](double each) { return each > 0.5; })) /
         double(uprights.size());
}

Eigen::Matrix3d
inWorld(const Eigen::Matrix3d& R, PoseFrame frame)
{
  return frame == PoseFrame::first_camera ? worldFromFirstCamera().linear() * R : R;
}

// The up axis of a sensor may be z or, for a camera, -y: the more upright one is used.
Uprights
uprightsOf(const std::vector<Eigen::Matrix3d>& rotations, PoseFrame frame)
{
  Uprights of_cameras, of_scanners;
  for (const Eigen::Matrix3d& R : rotations) {
    of_cameras.push_back(-inWorld(R, frame)(2, 1));
    of_scanners.push_back(R(2, 2));
  }
  const bool is_scanner = frame == PoseFrame::sensor &&
                          std::abs(meanOf(of_scanners)) > std::abs(meanOf(of_cameras));
  return is_scanner ? of_scanners : of_cameras;
}

// The rotation if its quaternion was stored as w x y z instead of x y z w.
Eigen::Matrix3d
withWFirst(const Eigen::Matrix3d& R)
{
  const Eigen::Quaterniond q(R);
  return Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()).toRotationMatrix();
}

std::string
doubtOfAxes(const std::vector<Eigen::Matrix3d>& rotations, PoseFrame frame,
            bool has_quaternions)
{
  const Uprights read = uprightsOf(rotations, frame);
  if (has_quaternions) {
    std::vector<Eigen::Matrix3d> turned;
    std::transform(rotations.begin(), rotations.end(), std::back_inserter(turned),
                   withWFirst);
    const Uprights other = uprightsOf(turned, frame);
    if (uprightFraction(other) >= 0.9 && meanOf(other) > meanOf(read) + 0.1)
      return "most poses are tilted or upside down, but upright if the quaternions "
             "have w first: expected x y z w";
  }
  if (medianOf(read) < -0.3)
    return "most poses are upside down: expected those of a world with z up, or of "
           "camera 0 with y down";
  if (uprightFraction(read) >= 0.5 || frame == PoseFrame::sensor)
    return {};
  return frame == PoseFrame::first_camera
             ? "most poses are tilted by more than 60 degrees against the first: "
               "expected camera 0 in the frame of the first one, y down"
             : "in most poses the camera looks up or down: expected poses in a world "
               "with z up";
}

std::vector<std::string>
doubtsOfWay(const Trajectory& poses, PoseFrame frame)
{
  const int up = frame == PoseFrame::first_camera ? 1 : 2;
  std::vector<double> steps;
  double way = 0.0, climbed = 0.0;
  double lowest = poses[0].translation()[up], highest = lowest;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Eigen::Vector3d step = poses[i].translation() - poses[i - 1].translation();
    steps.push_back(step.norm());
    way += step.norm();
    climbed += std::abs(step[up]);
    lowest = std::min(lowest, poses[i].translation()[up]);
    highest = std::max(highest, poses[i].translation()[up]);
  }
  std::vector<std::string> doubts;
  constexpr double highest_room = 10.0, longest_step = 30.0; // [m]
  if (highest - lowest > highest_room && climbed > 0.4 * way)
    doubts.push_back("the path climbs more steeply than a road: expected poses in a "
                     "world with z up, or of camera 0 with y down");
  constexpr double around_the_earth = 4e7; // [m]; maps refuse poses beyond it
  if (!steps.empty() && medianOf(steps) > longest_step &&
      medianOf(steps) < around_the_earth) {
    TextStream text;
    text << "half of the poses are more than " << medianOf(steps)
         << " m from the one before: are they in metres?";
    doubts.push_back(text.str());
  }
  return doubts;
}

} // namespace

std::vector<std::string>
doubtsOf(const Trajectory& poses, PoseFrame frame, bool has_quaternions)
{
  if (poses.empty())
    return {};
  std::vector<Eigen::Matrix3d> rotations;
  for (const Eigen::Isometry3d& pose : poses)
    rotations.push_back(pose.linear());
  std::vector<std::string> doubts = doubtsOfWay(poses, frame);
  const std::string axes = doubtOfAxes(rotations, frame, has_quaternions);
  if (!axes.empty())
    doubts.insert(doubts.begin(), axes);
  return doubts;
}

StoredTrajectory
readTrajectory(const std::string& path, PoseFrame frame)
{
  StoredTrajectory read{path, frame, trajectoryFormatOf(path), {}, {}};
  const bool is_tum = read.format == TrajectoryFormat::tum;
  Trajectory poses;
  if (is_tum) {
    read.poses = readTumTrajectory(path, &read.doubts);
    for (const TimedPose& timed : read.poses)
      poses.push_back(timed.pose);
  }
  else {
    poses = readKittiTrajectory(path, &read.doubts);
    for (const Eigen::Isometry3d& pose : poses)
      read.poses.push_back({0.0, pose});
  }
  for (const std::string& doubt : doubtsOf(poses, frame, is_tum))
    read.doubts.push_back(path + ": " + doubt);
  return read;
}

} // namespace pcl_semantic
