/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "odometry_engine.h"

#include <pcl_semantic/core/exceptions.h>

namespace pcl_semantic {

void
StereoOdometry::Parameters::validate() const
{
}

StereoOdometry::StereoOdometry(const StereoCamera& camera,
                               const Eigen::Isometry3d& T_camera0_camera,
                               const Parameters& parameters)
    : engine_(std::make_unique<Engine>(camera, T_camera0_camera, parameters))
{}

StereoOdometry::StereoOdometry(const StereoCamera& camera,
                               const Eigen::Isometry3d& T_camera0_camera)
    : StereoOdometry(camera, T_camera0_camera, Parameters())
{}

StereoOdometry::~StereoOdometry() = default;

Eigen::Isometry3d
StereoOdometry::pose(const StereoFrame& frame)
{
  return process(frame).T_world_camera;
}

const OdometryResult&
StereoOdometry::process(const StereoFrame& frame)
{
  return engine_->process(frame);
}

const OdometryResult&
StereoOdometry::result() const
{
  return engine_->result();
}

int
StereoOdometry::lostFrames() const
{
  return engine_->lostFrames();
}

} // namespace pcl_semantic
