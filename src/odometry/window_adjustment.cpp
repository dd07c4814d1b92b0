// SPDX-License-Identifier: BSD-3-Clause
#include "window_adjustment.h"

#include <Eigen/Cholesky>

#include <limits>

namespace pcl_semantic::odometry {

namespace {

constexpr double kHuber = 2.0;       // whitened length from which cost grows linearly
constexpr double kNearest = 1e-3;    // z of a scaled point in front of the camera
constexpr double kBehindCost = 1e6;  // of a point behind the camera
constexpr double kMinInverse = 1e-6; // inverse depth of what is at infinity [1/m]

struct Robust {
  double cost = 0.0;
  double weight = 0.0;
};

Robust
huber(double squared)
{
  if (squared <= kHuber * kHuber)
    return {squared, 1.0};
  const double length = std::sqrt(squared);
  return {2.0 * kHuber * length - kHuber * kHuber, kHuber / length};
}

} // namespace

/** \brief What a measurement says against the model, whitened, and its derivatives. */
struct WindowAdjustment::Residual {
  Eigen::Vector3d value;
  double weight = 1.0;
  double cost = 0.0;
  Eigen::Matrix<double, 3, 6> by_frame, by_anchor;
  Eigen::Vector3d by_depth;
  double by_offset = 0.0; ///< of the disparity
};

void
WindowAdjustment::number()
{
  unknowns_ = 0;
  unknown_.clear();
  for (const Frame& frame : frames) {
    unknown_.push_back(frame.is_fixed ? -1 : unknowns_);
    unknowns_ += frame.is_fixed ? 0 : 6;
  }
  begin_.assign(points.size() + 1, 0);
  for (const Measurement& measurement : measurements)
    ++begin_[std::size_t(measurement.point) + 1];
  for (std::size_t i = 0; i < points.size(); ++i)
    begin_[i + 1] += begin_[i];
}

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
  Eigen::Vector3d residual =
      measurement.uvd - projectStereo(camera_, q, point.position.inverse_depth);
  residual.z() -= offset;
  return residual.cwiseProduct(noise_.whitening()).squaredNorm();
}

bool
WindowAdjustment::evaluate(const Measurement& measurement,
                           const Eigen::Isometry3d& T_world_anchor,
                           Residual& residual) const
{
  const AnchoredPoint& position = points[std::size_t(measurement.point)].position;
  const Eigen::Isometry3d motion =
      frames[std::size_t(measurement.frame)].T_camera_world * T_world_anchor;
  const Eigen::Vector3d q = scaledPoint(position, motion);
  if (q.z() < kNearest)
    return false;
  const Eigen::Vector3d whiten = noise_.whitening();
  residual.value = measurement.uvd - projectStereo(camera_, q, position.inverse_depth);
  residual.value.z() -= offset;
  residual.value = residual.value.cwiseProduct(whiten);
  const Robust robust = huber(residual.value.squaredNorm());
  residual.cost = robust.cost;
  residual.weight = robust.weight;
  const Eigen::Matrix3d by_point =
      whiten.asDiagonal() * projectionByPoint(camera_, q, position.inverse_depth);
  residual.by_frame = by_point * pointByCamera(q, position.inverse_depth);
  residual.by_anchor = -(by_point * motion.linear()) *
                       pointByCamera(position.ray, position.inverse_depth);
  residual.by_depth = by_point * motion.translation();
  residual.by_depth.z() += whiten.z() * camera_.fx * camera_.baseline / q.z();
  residual.by_offset = whiten.z();
  return true;
}

// The disparity where it was seen first.
void
WindowAdjustment::addPoint(std::size_t i, System& system) const
{
  const int o = unknowns_;
  const double slope = camera_.fx * camera_.baseline / noise_.disparity;
  const double by_offset = 1.0 / noise_.disparity;
  const double error = (points[i].anchor_disparity - offset) / noise_.disparity -
                       slope * points[i].position.inverse_depth;
  const Robust robust = huber(error * error);
  system.cost += robust.cost;
  system.point_H[i] = robust.weight * slope * slope;
  system.point_b[i] = robust.weight * slope * error;
  system.point_offset[i] = robust.weight * slope * by_offset;
  system.H(o, o) += robust.weight * by_offset * by_offset;
  system.b(o) += robust.weight * by_offset * error;
}

void
WindowAdjustment::addMeasurement(std::size_t m, const Residual& residual,
                                 System& system) const
{
  const Measurement& measurement = measurements[m];
  const std::size_t i = std::size_t(measurement.point);
  const int c = unknown_[std::size_t(measurement.frame)];
  const int a = unknown_[std::size_t(points[i].anchor)];
  const int o = unknowns_;
  const double weight = residual.weight;
  const auto add = [&](int at, const Eigen::Matrix<double, 3, 6>& J, Vector6d& cross) {
    const Eigen::Matrix<double, 6, 3> weighted = weight * J.transpose();
    system.H.block<6, 6>(at, at).noalias() += weighted * J;
    system.b.segment<6>(at).noalias() += weighted * residual.value;
    system.H.block<6, 1>(at, o) += residual.by_offset * weighted.col(2);
    cross.noalias() = weighted * residual.by_depth;
  };
  if (c >= 0)
    add(c, residual.by_frame, system.by_frame[m]);
  if (a >= 0)
    add(a, residual.by_anchor, system.by_anchor[m]);
  if (a >= 0 && c >= 0)
    system.H.block<6, 6>(std::min(a, c), std::max(a, c)).noalias() +=
        a < c ? Matrix6d(weight * residual.by_anchor.transpose() * residual.by_frame)
              : Matrix6d(weight * residual.by_frame.transpose() * residual.by_anchor);
  system.cost += residual.cost;
  system.point_H[i] += weight * residual.by_depth.squaredNorm();
  system.point_b[i] += weight * residual.by_depth.dot(residual.value);
  system.point_offset[i] += weight * residual.by_depth.z() * residual.by_offset;
  system.H(o, o) += weight * residual.by_offset * residual.by_offset;
  system.b(o) += weight * residual.by_offset * residual.value.z();
}

// Fills the upper triangle of H.
void
WindowAdjustment::linearize(System& system) const
{
  system.H.setZero(unknowns_ + 1, unknowns_ + 1);
  system.b.setZero(unknowns_ + 1);
  for (std::vector<double>* const each :
       {&system.point_H, &system.point_b, &system.point_offset})
    each->assign(points.size(), 0.0);
  system.by_frame.assign(measurements.size(), Vector6d::Zero());
  system.by_anchor.assign(measurements.size(), Vector6d::Zero());
  const double known = (offset_before - offset) / offset_deviation;
  system.cost = known * known;
  system.H(unknowns_, unknowns_) = 1.0 / (offset_deviation * offset_deviation);
  system.b(unknowns_) = known / offset_deviation;
  std::vector<Eigen::Isometry3d> T_world_camera;
  for (const Frame& frame : frames)
    T_world_camera.push_back(frame.T_camera_world.inverse());
  Residual residual;
  for (std::size_t i = 0; i < points.size(); ++i) {
    addPoint(i, system);
    for (std::size_t m = begin_[i]; m < begin_[i + 1]; ++m)
      if (evaluate(measurements[m], T_world_camera[std::size_t(points[i].anchor)],
                   residual))
        addMeasurement(m, residual, system);
      else
        system.cost += kBehindCost;
  }
}

// Eliminates the inverse depths; fills the upper triangle.
Eigen::MatrixXd
WindowAdjustment::reduce(const System& system, double damping,
                         Eigen::VectorXd& right) const
{
  const int o = unknowns_;
  Eigen::MatrixXd H = system.H;
  H.diagonal() *= 1.0 + damping;
  right = system.b;
  std::vector<std::pair<int, Vector6d>> blocks;
  for (std::size_t i = 0; i < points.size(); ++i) {
    blocks.clear();
    const int a = unknown_[std::size_t(points[i].anchor)];
    Vector6d anchor = Vector6d::Zero();
    for (std::size_t m = begin_[i]; m < begin_[i + 1]; ++m) {
      const int c = unknown_[std::size_t(measurements[m].frame)];
      if (c >= 0)
        blocks.emplace_back(c, system.by_frame[m]);
      anchor += system.by_anchor[m];
    }
    if (a >= 0)
      blocks.emplace_back(a, anchor);
    const double inverse = 1.0 / (system.point_H[i] * (1.0 + damping));
    const double offset_fraction = inverse * system.point_offset[i];
    for (const auto& [row, left] : blocks) {
      const Vector6d scaled = inverse * left;
      right.segment<6>(row) -= system.point_b[i] * scaled;
      H.block<6, 1>(row, o) -= system.point_offset[i] * scaled;
      for (const auto& [column, other] : blocks)
        if (row <= column)
          H.block<6, 6>(row, column).noalias() -= scaled * other.transpose();
    }
    H(o, o) -= offset_fraction * system.point_offset[i];
    right(o) -= offset_fraction * system.point_b[i];
  }
  return H;
}

void
WindowAdjustment::step(const System& system, double damping,
                       const Eigen::VectorXd& delta)
{
  const double offset_step = delta(unknowns_);
  for (std::size_t i = 0; i < points.size(); ++i) {
    double right = system.point_b[i] - system.point_offset[i] * offset_step;
    const int a = unknown_[std::size_t(points[i].anchor)];
    for (std::size_t m = begin_[i]; m < begin_[i + 1]; ++m) {
      const int c = unknown_[std::size_t(measurements[m].frame)];
      if (c >= 0)
        right -= system.by_frame[m].dot(delta.segment<6>(c));
      if (a >= 0)
        right -= system.by_anchor[m].dot(delta.segment<6>(a));
    }
    double& inverse_depth = points[i].position.inverse_depth;
    inverse_depth += right / (system.point_H[i] * (1.0 + damping));
    inverse_depth = std::max(inverse_depth, kMinInverse);
  }
  offset += offset_step;
  for (std::size_t f = 0; f < frames.size(); ++f)
    if (unknown_[f] >= 0)
      frames[f].T_camera_world =
          expMotion(delta.segment<6>(unknown_[f])) * frames[f].T_camera_world;
}

double
WindowAdjustment::solve(int iterations)
{
  number();
  double damping = 1e-6;
  System system;
  linearize(system);
  for (int i = 0; i < iterations; ++i) {
    Eigen::VectorXd right;
    const Eigen::MatrixXd H = reduce(system, damping, right);
    const Eigen::VectorXd delta = H.selfadjointView<Eigen::Upper>().ldlt().solve(right);
    const WindowAdjustment old = *this;
    const double old_cost = system.cost;
    if (delta.allFinite())
      step(system, damping, delta);
    linearize(system);
    if (!(system.cost <= old_cost) || !delta.allFinite()) {
      *this = old;
      linearize(system);
      damping = std::max(10.0 * damping, 1e-4);
    }
    else if (old_cost - system.cost < 1e-4 * old_cost)
      break;
    else
      damping *= 0.1;
  }
  return system.cost;
}

Matrix6d
WindowAdjustment::covariance(int frame) const
{
  System system;
  linearize(system);
  Eigen::VectorXd right;
  const Eigen::MatrixXd H = reduce(system, 0.0, right);
  const int c = unknown_.at(std::size_t(frame));
  const Matrix6d block = H.block<6, 6>(c, c).selfadjointView<Eigen::Upper>();
  return block.ldlt().solve(Matrix6d::Identity());
}

} // namespace pcl_semantic::odometry
