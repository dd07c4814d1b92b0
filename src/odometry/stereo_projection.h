// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/stereo_camera.h>

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

/** \brief Motion for one unit of time at constant velocity.
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

/** \brief Adjoint of \a motion, translation first: a small motion xi on its right
 * equals the motion adjoint * xi on its left. */
inline Matrix6d
adjoint(const Eigen::Isometry3d& motion)
{
  Matrix6d matrix = Matrix6d::Zero();
  matrix.topLeftCorner<3, 3>() = motion.linear();
  matrix.bottomRightCorner<3, 3>() = motion.linear();
  matrix.topRightCorner<3, 3>() = crossMatrix(motion.translation()) * motion.linear();
  return matrix;
}

/** \brief Standard deviations of a stereo measurement [px]. */
struct MeasurementNoise {
  double pixel = 0.15;    ///< of a feature's column and row in the left image
  double disparity = 0.3; ///< of its disparity, independent of the position

  /** \brief Factors that normalise all three standard deviations to 1. */
  Eigen::Vector3d
  whitening() const
  {
    return {1.0 / pixel, 1.0 / pixel, 1.0 / disparity};
  }
};

/** \brief A point in its first frame: direction with z = 1, and inverse depth [1/m].
 * The inverse depth of a far point is near 0 and stays well conditioned. */
struct AnchoredPoint {
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();
  double inverse_depth = 0.0;
};

/** \brief The point times its inverse depth, in a camera at \a motion (from the
 * anchor's frame to the camera's). */
inline Eigen::Vector3d
scaledPoint(const AnchoredPoint& point, const Eigen::Isometry3d& motion)
{
  return motion.linear() * point.ray + point.inverse_depth * motion.translation();
}

/** \brief Column, row and disparity [px] of scaledPoint() \a q, whose z is > 0. */
inline Eigen::Vector3d
projectStereo(const StereoCamera& camera, const Eigen::Vector3d& q,
              double inverse_depth)
{
  return {camera.fx * q.x() / q.z() + camera.cx, camera.fy * q.y() / q.z() + camera.cy,
          camera.fx * camera.baseline * inverse_depth / q.z()};
}

/** \brief Derivative of projectStereo() by q. */
inline Eigen::Matrix3d
projectionByPoint(const StereoCamera& camera, const Eigen::Vector3d& q,
                  double inverse_depth)
{
  const double iz = 1.0 / q.z();
  Eigen::Matrix3d J;
  J << camera.fx * iz, 0, -camera.fx * q.x() * iz * iz, 0, camera.fy * iz,
      -camera.fy * q.y() * iz * iz, 0, 0,
      -camera.fx * camera.baseline * inverse_depth * iz * iz;
  return J;
}

/** \brief Derivative of q by a small motion of the camera (in its own frame, left of
 * T_camera_anchor). */
inline Eigen::Matrix<double, 3, 6>
pointByCamera(const Eigen::Vector3d& q, double inverse_depth)
{
  Eigen::Matrix<double, 3, 6> J;
  J.leftCols<3>() = inverse_depth * Eigen::Matrix3d::Identity();
  J.rightCols<3>() = -crossMatrix(q);
  return J;
}

} // namespace pcl_semantic::odometry
