// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rigid_motion.h"

#include <pcl_semantic/core/stereo_camera.h>

namespace pcl_semantic::odometry {

/** \brief How exact a stereo measurement is, standard deviations [px]. */
struct MeasurementNoise {
  double pixel = 0.15;    ///< of a feature's place in the left image, each way
  double disparity = 0.3; ///< of its disparity, which errs independently of its place

  /** \brief Factors that make all three deviations 1. */
  Eigen::Vector3d
  whitening() const
  {
    return {1.0 / pixel, 1.0 / pixel, 1.0 / disparity};
  }
};

/** \brief A point as it was seen first: direction with z = 1, and 1 / depth [1/m]. A
 * point far away has an inverse depth near 0, which costs nothing. */
struct AnchoredPoint {
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();
  double inverse_depth = 0.0;
};

/** \brief The point times its inverse depth, in a camera that moved by \a motion (from
 * the anchor's frame to the camera's). */
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

/** \brief Its derivative by q. */
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

/** \brief Derivative of q by a small motion of the camera (in its own frame, in front
 * of T_camera_anchor). */
inline Eigen::Matrix<double, 3, 6>
pointByCamera(const Eigen::Vector3d& q, double inverse_depth)
{
  Eigen::Matrix<double, 3, 6> J;
  J.leftCols<3>() = inverse_depth * Eigen::Matrix3d::Identity();
  J.rightCols<3>() = -crossMatrix(q);
  return J;
}

} // namespace pcl_semantic::odometry
