// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stereo_projection.h"

#include <vector>

namespace pcl_semantic::odometry {

/** \brief Poses and inverse depths that explain a window of stereo measurements best.
 *
 * A point has one unknown, its inverse depth along the ray of the frame that saw it
 * first; the ray itself is exact by definition: it is what the later frames look for.
 * One more unknown is the offset that all measured disparities share: rectification is
 * never perfect, and how points near and far move tells. Minimises the sum of Huber's
 * cost of the whitened residuals (column, row, disparity) by Levenberg-Marquardt,
 * inverse depths eliminated by the Schur complement. */
struct WindowAdjustment {
  struct Frame {
    Eigen::Isometry3d T_camera_world = Eigen::Isometry3d::Identity();
    bool is_fixed = false;
  };

  struct Point {
    AnchoredPoint position;
    int anchor = 0;                ///< frame
    double anchor_disparity = 0.0; ///< measured there [px]
  };

  struct Measurement {
    int point = 0;
    int frame = 0;                                 ///< another than the anchor
    Eigen::Vector3d uvd = Eigen::Vector3d::Zero(); ///< column, row, disparity [px]
  };

  StereoCamera camera;
  MeasurementNoise noise;
  std::vector<Frame> frames;
  std::vector<Point> points;
  std::vector<Measurement> measurements; ///< those of a point one after the other

  double offset = 0.0;            ///< measured disparity minus the true one [px]
  double offset_before = 0.0;     ///< what is known of it already
  double offset_deviation = 1e-6; ///< and how well [px]

  /** \brief Changes poses, inverse depths and the offset. \return the cost reached */
  double solve(int iterations);

  /** \brief Squared length of a whitened residual, about 3 for a good measurement;
   * infinite behind the camera. */
  double squaredError(const Measurement& measurement) const;

  /** \brief After solve(): covariance of the small motion in front of the
   * T_camera_world of a free frame, all other poses taken for exact, for the noise as
   * it was given. */
  Matrix6d covariance(int frame) const;
};

} // namespace pcl_semantic::odometry
