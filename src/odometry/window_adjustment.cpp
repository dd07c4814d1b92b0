/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "window_adjustment.h"

#include <Eigen/Cholesky>

#include <limits>

namespace pcl_semantic::odometry {

namespace {

constexpr double kHuber = 2.0; // whitened length from which the cost grows linearly
constexpr double kBehind = 1e-3;

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
  const Eigen::Vector3d q = scaledPoint(point.place, motion);
  if (q.z() < kBehind)
    return std::numeric_limits<double>::infinity();
  const Eigen::Vector3d residual =
      measurement.uvd - projectStereo(camera_, q, point.place.inverse_depth);
  return residual.head<2>().squaredNorm() / (noise_.pixel * noise_.pixel) +
         residual.z() * residual.z() / (noise_.disparity * noise_.disparity);
}

double
WindowAdjustment::cost() const
{
  double sum = 0.0;
  for (const Measurement& measurement : measurements) {
    const double squared = squaredError(measurement);
    sum += std::isinf(squared) ? 1e6 : huber(squared).cost;
  }
  for (const Point& point : points) {
    const double error = (point.anchor_disparity -
                          camera_.fx * camera_.baseline * point.place.inverse_depth) /
                         noise_.disparity;
    sum += huber(error * error).cost;
  }
  return sum;
}

void
WindowAdjustment::linearize(System& system) const
{
  const Eigen::Vector3d whiten(1.0 / noise_.pixel, 1.0 / noise_.pixel,
                               1.0 / noise_.disparity);
  const double fb = camera_.fx * camera_.baseline;
  system.H.setZero(unknowns_, unknowns_);
  system.b.setZero(unknowns_);
  system.cost = 0.0;
  system.point_H.assign(points.size(), 0.0);
  system.point_b.assign(points.size(), 0.0);
  system.cross.assign(2 * measurements.size(), Vector6d::Zero());
  std::vector<Eigen::Isometry3d> T_world_camera;
  for (const Frame& frame : frames)
    T_world_camera.push_back(frame.T_camera_world.inverse());

  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point& point = points[i];
    const double rho = point.place.inverse_depth;
    const double error = (point.anchor_disparity - fb * rho) * whiten.z();
    const Robust prior = huber(error * error);
    const double slope = fb * whiten.z();
    system.cost += prior.cost;
    system.point_H[i] = prior.weight * slope * slope;
    system.point_b[i] = prior.weight * slope * error;
    const int a = unknown_[std::size_t(point.anchor)];
    for (std::size_t m = begin_[i]; m < begin_[i + 1]; ++m) {
      const Measurement& measurement = measurements[m];
      const Eigen::Isometry3d motion =
          frames[std::size_t(measurement.frame)].T_camera_world *
          T_world_camera[std::size_t(point.anchor)];
      const Eigen::Vector3d q = scaledPoint(point.place, motion);
      if (q.z() < kBehind) {
        system.cost += 1e6;
        continue;
      }
      const Eigen::Vector3d residual =
          whiten.cwiseProduct(measurement.uvd - projectStereo(camera_, q, rho));
      const Robust robust = huber(residual.squaredNorm());
      system.cost += robust.cost;
      const Eigen::Matrix3d Jq =
          whiten.asDiagonal() * projectionByPoint(camera_, q, rho);
      Eigen::Vector3d Jr = Jq * motion.translation();
      Jr.z() += whiten.z() * fb / q.z();
      system.point_H[i] += robust.weight * Jr.squaredNorm();
      system.point_b[i] += robust.weight * Jr.dot(residual);
      const int c = unknown_[std::size_t(measurement.frame)];
      Eigen::Matrix<double, 3, 6> Jc, Ja;
      if (c >= 0) {
        Jc = Jq * pointByCamera(q, rho);
        system.H.block<6, 6>(c, c).noalias() += robust.weight * Jc.transpose() * Jc;
        system.b.segment<6>(c).noalias() += robust.weight * Jc.transpose() * residual;
        system.cross[2 * m].noalias() = robust.weight * Jc.transpose() * Jr;
      }
      if (a >= 0) {
        Ja = -Jq * motion.linear() * pointByCamera(point.place.ray, rho);
        system.H.block<6, 6>(a, a).noalias() += robust.weight * Ja.transpose() * Ja;
        system.b.segment<6>(a).noalias() += robust.weight * Ja.transpose() * residual;
        system.cross[2 * m + 1].noalias() = robust.weight * Ja.transpose() * Jr;
      }
      if (a >= 0 && c >= 0) {
        const Matrix6d block = robust.weight * Jc.transpose() * Ja;
        system.H.block<6, 6>(c, a) += block;
        system.H.block<6, 6>(a, c) += block.transpose();
      }
    }
  }
}

Eigen::MatrixXd
WindowAdjustment::reduce(const System& system, double damping,
                         Eigen::VectorXd& right) const
{
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
        blocks.emplace_back(c, system.cross[2 * m]);
      anchor += system.cross[2 * m + 1];
    }
    if (a >= 0 && begin_[i] < begin_[i + 1])
      blocks.emplace_back(a, anchor);
    const double inverse = 1.0 / (system.point_H[i] * (1.0 + damping));
    for (const auto& [row, left] : blocks) {
      const Vector6d scaled = inverse * left;
      right.segment<6>(row) -= system.point_b[i] * scaled;
      for (const auto& [column, other] : blocks)
        H.block<6, 6>(row, column).noalias() -= scaled * other.transpose();
    }
  }
  return H;
}

void
WindowAdjustment::step(const System& system, double damping,
                       const Eigen::VectorXd& delta)
{
  for (std::size_t i = 0; i < points.size(); ++i) {
    double right = system.point_b[i];
    const int a = unknown_[std::size_t(points[i].anchor)];
    for (std::size_t m = begin_[i]; m < begin_[i + 1]; ++m) {
      const int c = unknown_[std::size_t(measurements[m].frame)];
      if (c >= 0)
        right -= system.cross[2 * m].dot(delta.segment<6>(c));
      if (a >= 0)
        right -= system.cross[2 * m + 1].dot(delta.segment<6>(a));
    }
    double& inverse_depth = points[i].place.inverse_depth;
    inverse_depth += right / (system.point_H[i] * (1.0 + damping));
    inverse_depth = std::max(inverse_depth, 1e-6);
  }
  for (std::size_t f = 0; f < frames.size(); ++f)
    if (unknown_[f] >= 0)
      frames[f].T_camera_world =
          expMotion(delta.segment<6>(unknown_[f])) * frames[f].T_camera_world;
}

double
WindowAdjustment::solve(int iterations)
{
  number();
  if (unknowns_ == 0)
    return cost();
  double damping = 1e-6;
  System system;
  linearize(system);
  for (int i = 0; i < iterations; ++i) {
    Eigen::VectorXd right;
    const Eigen::MatrixXd H = reduce(system, damping, right);
    const Eigen::VectorXd delta = H.ldlt().solve(right);
    const std::vector<Frame> old_frames = frames;
    const std::vector<Point> old_points = points;
    const double old_cost = system.cost;
    step(system, damping, delta);
    linearize(system);
    if (!(system.cost <= old_cost) || !delta.allFinite()) {
      frames = old_frames;
      points = old_points;
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
  return H.block<6, 6>(c, c).ldlt().solve(Matrix6d::Identity());
}

} // namespace pcl_semantic::odometry
