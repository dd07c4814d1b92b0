// SPDX-License-Identifier: BSD-3-Clause
#include "pose_ransac.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <random>

namespace pcl_semantic::odometry {

namespace {

constexpr int kTrials = 60;        // at most
constexpr double kThreshold = 2.0; // residual of an inlier [px]
constexpr double kNearest = 1e-3;  // z of a scaled point in front of the camera

class PoseRansac {
public:
  PoseRansac(const StereoCamera& camera, const MeasurementNoise& noise,
             const std::vector<PoseMeasurement>& measurements)
      : camera_(camera), noise_(noise), measurements_(measurements)
  {}

  // The pose of the sample with the most inliers; the predicted pose is a candidate
  // too.
  Eigen::Isometry3d
  bestOfSamples(const Eigen::Isometry3d& predicted) const
  {
    const std::size_t n = measurements_.size();
    const auto count = [&](const Eigen::Isometry3d& pose) {
      const std::vector<char> flags = agreeing(pose);
      return std::size_t(std::count(flags.begin(), flags.end(), 1));
    };
    std::mt19937 random(1);
    Eigen::Isometry3d best = predicted;
    std::size_t most = count(best);
    std::vector<const PoseMeasurement*> sample(3);
    for (int trial = 0; trial < kTrials && most < n; ++trial) {
      for (const PoseMeasurement*& one : sample)
        one = &measurements_[random() % n];
      Eigen::Isometry3d pose = predicted;
      if (sample[0] == sample[1] || sample[1] == sample[2] || sample[0] == sample[2] ||
          !refine(sample, 8, pose))
        continue;
      if (const std::size_t number = count(pose); number > most) {
        most = number;
        best = pose;
      }
      // Stops when a sample without outliers has been drawn with near certainty.
      const double fraction = double(most) / double(n);
      if (most > 0 &&
          trial + 1 >= std::log(1e-4) / std::log1p(-fraction * fraction * fraction))
        break;
    }
    return best;
  }

  // One flag per measurement: whether it agrees with a pose.
  std::vector<char>
  agreeing(const Eigen::Isometry3d& T_camera_world) const
  {
    std::vector<char> flags;
    for (const auto& [position, uvd] : measurements_) {
      const Eigen::Vector3d q = scaledPoint(position, T_camera_world);
      const auto seen = projectStereo(camera_, q, position.inverse_depth);
      flags.push_back(q.z() >= kNearest &&
                      (uvd - seen).squaredNorm() < kThreshold * kThreshold);
    }
    return flags;
  }

  // Gauss-Newton with Huber's weights.
  bool
  refine(const std::vector<const PoseMeasurement*>& measurements, int iterations,
         Eigen::Isometry3d& T_camera_world) const
  {
    const Eigen::Vector3d whiten = noise_.whitening();
    for (int i = 0; i < iterations; ++i) {
      Matrix6d H = Matrix6d::Zero();
      Vector6d b = Vector6d::Zero();
      for (const PoseMeasurement* measurement : measurements) {
        const double rho = measurement->position.inverse_depth;
        const Eigen::Vector3d q = scaledPoint(measurement->position, T_camera_world);
        if (q.z() < kNearest)
          continue;
        const Eigen::Vector3d residual =
            whiten.cwiseProduct(measurement->uvd - projectStereo(camera_, q, rho));
        const Eigen::Matrix<double, 3, 6> J = whiten.asDiagonal() *
                                              projectionByPoint(camera_, q, rho) *
                                              pointByCamera(q, rho);
        const double length = residual.norm();
        const double weight = length > 2.0 ? 2.0 / length : 1.0;
        H.noalias() += weight * J.transpose() * J;
        b.noalias() += weight * J.transpose() * residual;
      }
      H.diagonal().array() += 1e-6;
      const Vector6d delta = H.ldlt().solve(b);
      if (!delta.allFinite() || delta.norm() > 1e3)
        return false;
      T_camera_world = expMotion(delta) * T_camera_world;
      if (delta.norm() < 1e-6)
        break;
    }
    return true;
  }

private:
  const StereoCamera& camera_;
  const MeasurementNoise& noise_;
  const std::vector<PoseMeasurement>& measurements_;
};

} // namespace

std::vector<char>
estimatePose(const StereoCamera& camera, const MeasurementNoise& noise,
             const std::vector<PoseMeasurement>& measurements,
             Eigen::Isometry3d& T_camera_world)
{
  if (measurements.size() < 3)
    return std::vector<char>(measurements.size(), 0);
  const PoseRansac ransac(camera, noise, measurements);
  T_camera_world = ransac.bestOfSamples(T_camera_world);
  for (int round = 0; round < 2; ++round) {
    const std::vector<char> flags = ransac.agreeing(T_camera_world);
    std::vector<const PoseMeasurement*> inliers;
    for (std::size_t i = 0; i < flags.size(); ++i)
      if (flags[i])
        inliers.push_back(&measurements[i]);
    if (inliers.size() >= 3)
      ransac.refine(inliers, 5, T_camera_world);
  }
  return ransac.agreeing(T_camera_world);
}

} // namespace pcl_semantic::odometry
