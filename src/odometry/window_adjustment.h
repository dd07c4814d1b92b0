// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stereo_projection.h"

#include <vector>

namespace pcl_semantic::odometry {

/** \brief Bundle adjustment of a window: the poses and inverse depths that fit its
 * stereo measurements best.
 *
 * A point has one unknown, its inverse depth along the ray of its first frame. The ray
 * itself is exact by definition, because later frames track its image. A further
 * unknown is the offset that all measured disparities share because of rectification
 * errors; the motions of near and far points determine it. Minimises the sum of Huber's
 * cost of the whitened residuals (column, row, disparity) by Levenberg-Marquardt; the
 * Schur complement eliminates inverse depths. */
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
    int frame = 0;                                 ///< not the anchor
    Eigen::Vector3d uvd = Eigen::Vector3d::Zero(); ///< column, row, disparity [px]
  };

  StereoCamera camera;
  MeasurementNoise noise;
  std::vector<Frame> frames;
  std::vector<Point> points;
  std::vector<Measurement> measurements; ///< grouped by point

  double offset = 0.0;            ///< measured minus true disparity [px]
  double offset_before = 0.0;     ///< its prior mean
  double offset_deviation = 1e-6; ///< its prior standard deviation [px]

  /** \brief Optimises poses, inverse depths and the offset. \return the final cost */
  double solve(int iterations);

  /** \brief Squared whitened residual, about 3 for a good measurement; infinite behind
   * the camera. */
  double squaredError(const Measurement& measurement) const;

  /** \brief Covariance, after solve(), of a small motion left of the T_camera_world of
   * a free frame, given all other poses and the nominal noise. */
  Matrix6d covariance(int frame) const;
};

} // namespace pcl_semantic::odometry
