/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include "stereo_projection.h"

#include <vector>

namespace pcl_semantic::odometry {

/** \brief Poses and inverse depths that explain a window of stereo measurements best.
 *
 * A point has one unknown, its inverse depth along the ray of the frame that saw it
 * first; the ray itself is exact by definition: it is what the later frames look for.
 * Minimises the sum of Huber's cost of the whitened residuals (column, row, disparity)
 * by Levenberg-Marquardt, inverse depths eliminated by the Schur complement. */
class WindowAdjustment {
public:
  struct Frame {
    Eigen::Isometry3d T_camera_world = Eigen::Isometry3d::Identity();
    bool is_fixed = false;
  };

  struct Point {
    AnchoredPoint place;
    int anchor = 0;                ///< frame
    double anchor_disparity = 0.0; ///< measured there [px]
  };

  struct Measurement {
    int point = 0;
    int frame = 0; ///< another than the anchor
    Eigen::Vector3d uvd = Eigen::Vector3d::Zero(); ///< column, row, disparity [px]
  };

  WindowAdjustment(const StereoCamera& camera, const MeasurementNoise& noise)
      : camera_(camera), noise_(noise)
  {}

  std::vector<Frame> frames;
  std::vector<Point> points;
  std::vector<Measurement> measurements; ///< those of a point one after the other

  /** \brief Changes poses and inverse depths. \return the cost reached */
  double solve(int iterations);

  /** \brief Squared length of a whitened residual, about 3 for a good measurement;
  * infinite behind the camera. */
  double squaredError(const Measurement& measurement) const;

  /** \brief Covariance of the small motion in front of the T_camera_world of a free
   * frame, all other poses taken for exact, for the noise as it was given. */
  Matrix6d covariance(int frame) const;

private:
  struct System {
    Eigen::MatrixXd H;
    Eigen::VectorXd b;
    double cost = 0.0;
    std::vector<double> point_H, point_b;
    std::vector<Vector6d> cross; ///< two a measurement: its frame, its point's anchor
  };

  void number();

  void linearize(System& system) const;

  Eigen::MatrixXd reduce(const System& system, double damping,
                         Eigen::VectorXd& right) const;

  void step(const System& system, double damping, const Eigen::VectorXd& delta);

  double cost() const;

  StereoCamera camera_;
  MeasurementNoise noise_;
  std::vector<int> unknown_; ///< of a frame: where its six unknowns are, or -1
  int unknowns_ = 0;
  std::vector<std::size_t> begin_; ///< first measurement of each point, and the end
};

} // namespace pcl_semantic::odometry
