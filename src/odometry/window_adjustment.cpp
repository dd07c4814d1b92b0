// SPDX-License-Identifier: BSD-3-Clause
#include "window_adjustment.h"

#include <Eigen/Cholesky>

#include <limits>
#include <utility>

namespace pcl_semantic::odometry {

namespace {

constexpr double kHuber = 2.0;       // whitened residual from which cost grows linearly
constexpr double kNearest = 1e-3;    // z of a scaled point in front of the camera
constexpr double kBehindCost = 1e6;  // of a point behind the camera
constexpr double kMinInverse = 1e-6; // inverse depth of a point at infinity [1/m]

struct Robust {
  double cost, weight;
};

Robust
huber(double squared)
{
  if (squared <= kHuber * kHuber)
    return {squared, 1.0};
  const double length = std::sqrt(squared);
  return {2.0 * kHuber * length - kHuber * kHuber, kHuber / length};
}

// Whitened residual of a scaled point in front of the camera.
Eigen::Vector3d
residualOf(const WindowAdjustment& window,
           const WindowAdjustment::Measurement& measurement, const Eigen::Vector3d& q)
{
  const double inverse_depth =
      window.points[std::size_t(measurement.point)].position.inverse_depth;
  Eigen::Vector3d residual =
      measurement.uvd - projectStereo(window.camera, q, inverse_depth);
  residual.z() -= window.offset;
  return residual.cwiseProduct(window.noise.whitening());
}

/** \brief The normal equations of a window: poses, then the offset; inverse depths
 * separately. */
class NormalEquations {
public:
  explicit NormalEquations(const WindowAdjustment& window) : window_(window)
  {
    for (const WindowAdjustment::Frame& frame : window.frames) {
      unknown_.push_back(frame.is_fixed ? -1 : offset_);
      offset_ += frame.is_fixed ? 0 : 6;
    }
    begin_.assign(window.points.size() + 1, 0);
    for (const WindowAdjustment::Measurement& measurement : window.measurements)
      ++begin_[std::size_t(measurement.point) + 1];
    for (std::size_t i = 0; i < window.points.size(); ++i)
      begin_[i + 1] += begin_[i];
    linearize();
  }

  double
  cost() const
  {
    return cost_;
  }

  /** \brief Updates the equations after a change of the window. */
  void
  linearize()
  {
    H_.setZero(offset_ + 1, offset_ + 1);
    b_.setZero(offset_ + 1);
    by_points_.assign(window_.points.size(), {});
    by_frame_.assign(window_.measurements.size(), Vector6d::Zero());
    by_anchor_.assign(window_.measurements.size(), Vector6d::Zero());
    const double deviation = window_.offset_deviation;
    const double known = (window_.offset_before - window_.offset) / deviation;
    cost_ = known * known;
    H_(offset_, offset_) = 1.0 / (deviation * deviation);
    b_(offset_) = known / deviation;
    std::vector<Eigen::Isometry3d> T_world_camera;
    for (const WindowAdjustment::Frame& frame : window_.frames)
      T_world_camera.push_back(frame.T_camera_world.inverse());
    for (std::size_t i = 0; i < window_.points.size(); ++i) {
      addPoint(i);
      for (std::size_t m = begin_[i]; m < begin_[i + 1]; ++m)
        addMeasurement(m, T_world_camera[std::size_t(window_.points[i].anchor)]);
    }
  }

  /** \brief Eliminates the inverse depths (Schur complement); fills the upper triangle.
   */
  Eigen::MatrixXd
  reduce(double damping, Eigen::VectorXd& right) const
  {
    Eigen::MatrixXd H = H_;
    H.diagonal() *= 1.0 + damping;
    right = b_;
    std::vector<std::pair<int, Vector6d>> blocks;
    for (std::size_t i = 0; i < by_points_.size(); ++i) {
      blocks.clear();
      Vector6d anchor = Vector6d::Zero();
      for (std::size_t m = begin_[i]; m < begin_[i + 1]; ++m) {
        if (const int c = unknownOf(window_.measurements[m].frame); c >= 0)
          blocks.emplace_back(c, by_frame_[m]);
        anchor += by_anchor_[m];
      }
      if (const int a = unknownOf(window_.points[i].anchor); a >= 0)
        blocks.emplace_back(a, anchor);
      const ByPoint& point = by_points_[i];
      const double inverse = 1.0 / (point.H * (1.0 + damping));
      const double offset_fraction = inverse * point.offset;
      for (const auto& [row, left] : blocks) {
        const Vector6d scaled = inverse * left;
        right.segment<6>(row) -= point.b * scaled;
        H.block<6, 1>(row, offset_) -= point.offset * scaled;
        for (const auto& [column, other] : blocks)
          if (row <= column)
            H.block<6, 6>(row, column).noalias() -= scaled * other.transpose();
      }
      H(offset_, offset_) -= offset_fraction * point.offset;
      right(offset_) -= offset_fraction * point.b;
    }
    return H;
  }

  /** \brief Moves the window of the constructor.
   * \param[in] delta solution of the system of reduce() */
  void
  step(double damping, const Eigen::VectorXd& delta, WindowAdjustment& window) const
  {
    for (std::size_t i = 0; i < by_points_.size(); ++i) {
      const ByPoint& point = by_points_[i];
      double right = point.b - point.offset * delta(offset_);
      const int a = unknownOf(window.points[i].anchor);
      for (std::size_t m = begin_[i]; m < begin_[i + 1]; ++m) {
        if (const int c = unknownOf(window.measurements[m].frame); c >= 0)
          right -= by_frame_[m].dot(delta.segment<6>(c));
        if (a >= 0)
          right -= by_anchor_[m].dot(delta.segment<6>(a));
      }
      double& inverse_depth = window.points[i].position.inverse_depth;
      inverse_depth =
          std::max(inverse_depth + right / (point.H * (1.0 + damping)), kMinInverse);
    }
    window.offset += delta(offset_);
    for (std::size_t f = 0; f < window.frames.size(); ++f)
      if (unknown_[f] >= 0)
        window.frames[f].T_camera_world =
            expMotion(delta.segment<6>(unknown_[f])) * window.frames[f].T_camera_world;
  }

  /** \brief Index of the six unknowns of a frame, or -1. */
  int
  unknownOf(int frame) const
  {
    return unknown_[std::size_t(frame)];
  }

private:
  /** \brief Derivatives by a point's inverse depth: with itself, the residual and the
   * offset. */
  struct ByPoint {
    double H = 0.0, b = 0.0, offset = 0.0;
  };

  // Adds the disparity measured in the anchor frame.
  void
  addPoint(std::size_t i)
  {
    const double by_offset = 1.0 / window_.noise.disparity;
    const double slope =
        window_.camera.fx * window_.camera.baseline / window_.noise.disparity;
    const WindowAdjustment::Point& point = window_.points[i];
    const double error =
        (point.anchor_disparity - window_.offset) / window_.noise.disparity -
        slope * point.position.inverse_depth;
    const auto [cost, weight] = huber(error * error);
    cost_ += cost;
    by_points_[i] = {weight * slope * slope, weight * slope * error,
                     weight * slope * by_offset};
    H_(offset_, offset_) += weight * by_offset * by_offset;
    b_(offset_) += weight * by_offset * error;
  }

  void
  addMeasurement(std::size_t m, const Eigen::Isometry3d& T_world_anchor)
  {
    const WindowAdjustment::Measurement& measurement = window_.measurements[m];
    const std::size_t i = std::size_t(measurement.point);
    const AnchoredPoint& position = window_.points[i].position;
    const Eigen::Isometry3d motion =
        window_.frames[std::size_t(measurement.frame)].T_camera_world * T_world_anchor;
    const Eigen::Vector3d q = scaledPoint(position, motion);
    if (q.z() < kNearest) {
      cost_ += kBehindCost;
      return;
    }
    const Eigen::Vector3d residual = residualOf(window_, measurement, q);
    const auto [cost, weight] = huber(residual.squaredNorm());
    const Eigen::Vector3d whiten = window_.noise.whitening();
    const double by_offset = whiten.z();
    const Eigen::Matrix3d by_q =
        whiten.asDiagonal() *
        projectionByPoint(window_.camera, q, position.inverse_depth);
    const Eigen::Matrix<double, 3, 6> by_frame =
        by_q * pointByCamera(q, position.inverse_depth);
    const Eigen::Matrix<double, 3, 6> by_anchor =
        -(by_q * motion.linear()) * pointByCamera(position.ray, position.inverse_depth);
    Eigen::Vector3d by_depth = by_q * motion.translation();
    by_depth.z() += whiten.z() * window_.camera.fx * window_.camera.baseline / q.z();

    const auto add = [&, w = weight](int at, const Eigen::Matrix<double, 3, 6>& J,
                                     Vector6d& cross) {
      const Eigen::Matrix<double, 6, 3> weighted = w * J.transpose();
      H_.block<6, 6>(at, at).noalias() += weighted * J;
      b_.segment<6>(at).noalias() += weighted * residual;
      H_.block<6, 1>(at, offset_) += by_offset * weighted.col(2);
      cross.noalias() = weighted * by_depth;
    };
    const int c = unknownOf(measurement.frame), a = unknownOf(window_.points[i].anchor);
    if (c >= 0)
      add(c, by_frame, by_frame_[m]);
    if (a >= 0)
      add(a, by_anchor, by_anchor_[m]);
    if (a >= 0 && c >= 0)
      H_.block<6, 6>(std::min(a, c), std::max(a, c)).noalias() +=
          a < c ? Matrix6d(weight * by_anchor.transpose() * by_frame)
                : Matrix6d(weight * by_frame.transpose() * by_anchor);
    cost_ += cost;
    by_points_[i].H += weight * by_depth.squaredNorm();
    by_points_[i].b += weight * by_depth.dot(residual);
    by_points_[i].offset += weight * by_depth.z() * by_offset;
    H_(offset_, offset_) += weight * by_offset * by_offset;
    b_(offset_) += weight * by_offset * residual.z();
  }

  const WindowAdjustment& window_;
  std::vector<int> unknown_;       ///< by frame
  int offset_ = 0;                 ///< after the unknowns of the poses
  std::vector<std::size_t> begin_; ///< first measurement of each point, and the end
  double cost_ = 0.0;
  Eigen::MatrixXd H_; ///< upper triangle
  Eigen::VectorXd b_;
  std::vector<ByPoint> by_points_;
  std::vector<Vector6d> by_frame_, by_anchor_; ///< by measurement, with its point
};

} // namespace

double
WindowAdjustment::squaredError(const Measurement& measurement) const
{
  const Point& point = points[std::size_t(measurement.point)];
  const Eigen::Isometry3d motion =
      frames[std::size_t(measurement.frame)].T_camera_world *
      frames[std::size_t(point.anchor)].T_camera_world.inverse();
  const Eigen::Vector3d q = scaledPoint(point.position, motion);
  if (q.z() < kNearest)
    return std::numeric_limits<double>::infinity();
  return residualOf(*this, measurement, q).squaredNorm();
}

double
WindowAdjustment::solve(int iterations)
{
  double damping = 1e-6;
  NormalEquations equations(*this);
  for (int i = 0; i < iterations; ++i) {
    Eigen::VectorXd right;
    const Eigen::MatrixXd H = equations.reduce(damping, right);
    const Eigen::VectorXd delta = H.selfadjointView<Eigen::Upper>().ldlt().solve(right);
    const WindowAdjustment old = *this;
    const double old_cost = equations.cost();
    if (delta.allFinite())
      equations.step(damping, delta, *this);
    equations.linearize();
    if (!(equations.cost() <= old_cost) || !delta.allFinite()) {
      *this = old;
      equations.linearize();
      damping = std::max(10.0 * damping, 1e-4);
    }
    else if (old_cost - equations.cost() < 1e-4 * old_cost)
      break;
    else
      damping *= 0.1;
  }
  return equations.cost();
}

Matrix6d
WindowAdjustment::covariance(int frame) const
{
  const NormalEquations equations(*this);
  Eigen::VectorXd right;
  const Eigen::MatrixXd H = equations.reduce(0.0, right);
  const int c = equations.unknownOf(frame);
  const Matrix6d block = H.block<6, 6>(c, c).selfadjointView<Eigen::Upper>();
  return block.ldlt().solve(Matrix6d::Identity());
}

} // namespace pcl_semantic::odometry
