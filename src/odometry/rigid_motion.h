// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

namespace pcl_semantic::odometry {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

inline Eigen::Matrix3d
crossMatrix(const Eigen::Vector3d& v)
{
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

/** \brief The motion that a constant velocity makes in one unit of time.
 * \param[in] velocity translation [m], then rotation [rad] */
inline Eigen::Isometry3d
expMotion(const Vector6d& velocity)
{
  const Eigen::Vector3d omega = velocity.tail<3>();
  const double angle = omega.norm();
  const Eigen::Matrix3d W = crossMatrix(omega);
  const bool tiny = angle < 1e-5;
  const double a = tiny ? 0.5 : (1.0 - std::cos(angle)) / (angle * angle);
  const double b =
      tiny ? 1.0 / 6.0 : (angle - std::sin(angle)) / (angle * angle * angle);
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (angle > 0.0)
    motion.linear() = Eigen::AngleAxisd(angle, omega / angle).toRotationMatrix();
  motion.translation() =
      (Eigen::Matrix3d::Identity() + a * W + b * W * W) * velocity.head<3>();
  return motion;
}

/** \brief The inverse of expMotion(), for rotations of less than half a turn. */
inline Vector6d
logMotion(const Eigen::Isometry3d& motion)
{
  const Eigen::AngleAxisd rotation(motion.linear());
  const double angle = rotation.angle();
  const Eigen::Matrix3d W = crossMatrix(angle * rotation.axis());
  const double half = 0.5 * angle;
  const double c =
      angle < 1e-5 ? 1.0 / 12.0 : (1.0 - half / std::tan(half)) / (angle * angle);
  Vector6d velocity;
  velocity.tail<3>() = angle * rotation.axis();
  velocity.head<3>() =
      (Eigen::Matrix3d::Identity() - 0.5 * W + c * W * W) * motion.translation();
  return velocity;
}

/** \brief How a small motion in front of \a motion becomes one behind it: the adjoint,
 * translation first. */
inline Matrix6d
adjoint(const Eigen::Isometry3d& motion)
{
  Matrix6d matrix = Matrix6d::Zero();
  matrix.topLeftCorner<3, 3>() = motion.linear();
  matrix.bottomRightCorner<3, 3>() = motion.linear();
  matrix.topRightCorner<3, 3>() = crossMatrix(motion.translation()) * motion.linear();
  return matrix;
}

} // namespace pcl_semantic::odometry
