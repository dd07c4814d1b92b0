// SPDX-License-Identifier: BSD-3-Clause
#include "pose_ransac.h"

#include <Eigen/Cholesky>

#include <random>

namespace pcl_semantic::odometry {

bool
PoseRansac::agrees(const PoseMeasurement& measurement,
                   const Eigen::Isometry3d& T_camera_world) const
{
  const Eigen::Vector3d q = scaledPoint(measurement.position, T_camera_world);
  if (q.z() < 1e-3)
    return false;
  const Eigen::Vector3d residual =
      measurement.uvd - projectStereo(camera_, q, measurement.position.inverse_depth);
  return residual.squaredNorm() < threshold * threshold;
}

// Gauss-Newton with Huber's weights.
bool
PoseRansac::refine(const std::vector<const PoseMeasurement*>& measurements,
                   int iterations, Eigen::Isometry3d& T_camera_world) const
{
  const Eigen::Vector3d whiten = noise_.whitening();
  for (int i = 0; i < iterations; ++i) {
    Matrix6d H = Matrix6d::Zero();
    Vector6d b = Vector6d::Zero();
    for (const PoseMeasurement* measurement : measurements) {
      const double rho = measurement->position.inverse_depth;
      const Eigen::Vector3d q = scaledPoint(measurement->position, T_camera_world);
      if (q.z() < 1e-3)
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

// The pose of the sample that most measurements agree with; the predicted one counts
// too.
Eigen::Isometry3d
PoseRansac::bestOfSamples(const std::vector<PoseMeasurement>& measurements,
                          const Eigen::Isometry3d& predicted) const
{
  const std::size_t n = measurements.size();
  const auto count = [&](const Eigen::Isometry3d& pose) {
    std::size_t agreeing = 0;
    for (const PoseMeasurement& measurement : measurements)
      agreeing += agrees(measurement, pose);
    return agreeing;
  };
  std::mt19937 random(seed);
  Eigen::Isometry3d best = predicted;
  std::size_t most = count(best);
  std::vector<const PoseMeasurement*> sample(3);
  for (int trial = 0; trial < trials && most < n; ++trial) {
    for (const PoseMeasurement*& one : sample)
      one = &measurements[random() % n];
    Eigen::Isometry3d pose = predicted;
    if (sample[0] == sample[1] || sample[1] == sample[2] || sample[0] == sample[2] ||
        !refine(sample, 8, pose))
      continue;
    const std::size_t agreeing = count(pose);
    if (agreeing > most) {
      most = agreeing;
      best = pose;
    }
    // Enough when a sample without outliers has been drawn with near certainty.
    const double fraction = double(most) / double(n);
    if (most > 0 &&
        trial + 1 >= std::log(1e-4) / std::log1p(-fraction * fraction * fraction))
      break;
  }
  return best;
}

std::vector<char>
PoseRansac::estimate(const std::vector<PoseMeasurement>& measurements,
                     Eigen::Isometry3d& T_camera_world) const
{
  std::vector<char> inliers(measurements.size(), 0);
  if (measurements.size() < 3)
    return inliers;
  T_camera_world = bestOfSamples(measurements, T_camera_world);
  for (int round = 0; round < 2; ++round) {
    std::vector<const PoseMeasurement*> agreeing;
    for (const PoseMeasurement& measurement : measurements)
      if (agrees(measurement, T_camera_world))
        agreeing.push_back(&measurement);
    if (agreeing.size() >= 3)
      refine(agreeing, 5, T_camera_world);
  }
  for (std::size_t i = 0; i < measurements.size(); ++i)
    inliers[i] = agrees(measurements[i], T_camera_world);
  return inliers;
}

} // namespace pcl_semantic::odometry
