// SPDX-License-Identifier: BSD-3-Clause
#include "odometry_engine.h"

#include <pcl_semantic/core/exceptions.h>

namespace pcl_semantic {

void
StereoOdometry::Parameters::validate() const
{
  const auto require = [](bool is_good, const char* name, double value,
                          const char* expected) {
    if (!is_good)
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          name << " is " << value << ", expected " << expected);
  };
  require(features >= 20 && features <= 100000, "features", features, "20 to 100000");
  require(window >= 2 && window <= 100, "window", window, "2 to 100");
  require(iterations >= 1 && iterations <= 1000, "iterations", iterations, "1 to 1000");
  require(minimum_inliers >= 6, "minimum_inliers", minimum_inliers, "6 or more");
  require(max_disparity >= 0 && max_disparity <= 4096, "max_disparity", max_disparity,
          "0 to 4096 px");
  require(keyframe_flow >= 0.0 && keyframe_flow <= 1.0, "keyframe_flow", keyframe_flow,
          "0 to 1");
  require(pixel_noise > 0.0 && pixel_noise <= 100.0, "pixel_noise", pixel_noise,
          "more than 0 and at most 100 px");
  require(disparity_noise > 0.0 && disparity_noise <= 100.0, "disparity_noise",
          disparity_noise, "more than 0 and at most 100 px");
  require(offset_drift >= 0.0 && offset_drift <= 100.0, "offset_drift", offset_drift,
          "0 to 100 px");
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
