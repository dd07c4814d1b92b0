// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/synthetic_scene.h>

#include "core/fail.h"
#include "synthetic_street.h"

#include <limits>

namespace pcl_semantic {

namespace {

using synthetic::sinCos;

/** \brief Camera axes (x right, y down, z forward) in the world's. */
Eigen::Matrix3d
worldFromCamera()
{
  Eigen::Matrix3d rotation;
  rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return rotation;
}

/** \brief Turn about the vertical (to the left), then nose down, world axes. */
Eigen::Matrix3d
turn(double heading, double pitch)
{
  const auto [s, c] = sinCos(heading);
  const auto [sp, cp] = sinCos(pitch);
  Eigen::Matrix3d yaw;
  yaw << c, -s, 0, s, c, 0, 0, 0, 1;
  Eigen::Matrix3d nod;
  nod << cp, 0, sp, 0, 1, 0, -sp, 0, cp;
  return yaw * nod;
}

} // namespace

SyntheticScene::SyntheticScene(std::uint32_t seed, int frames)
    : seed_(seed), frames_(frames)
{
  if (frames < 1 || frames > 100000)
    fail<InvalidParameterException>("frames of a synthetic scene: ", frames,
                                    ", expected 1 to 100000");
  street_ = std::make_shared<synthetic::Street>(seed, frames * metres_per_frame);
}

Eigen::Isometry3d
SyntheticScene::pose(int frame) const
{
  if (frame < 0 || frame >= frames_)
    fail<InvalidParameterException>("frame ", frame, " of a synthetic scene with ",
                                    frames_, " frames");
  // A car does not run on rails: it weaves, nods and bobs, smoothly and not in frame 0.
  const double weave = sinCos(2.0 * (frame % 31) * M_PI / 31.0 - M_PI).second;
  const double nod = sinCos(2.0 * (frame % 9) * M_PI / 9.0 - M_PI).first;
  const synthetic::RoadLine& road = street_->road();
  const synthetic::RoadPoint position{frame * metres_per_frame,
                                      synthetic::Street::lane + 0.1 * (1.0 + weave)};
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = turn(road.heading(position.s), 0.004 * nod) * worldFromCamera();
  pose.translation().head<2>() = road.position(position);
  pose.translation().z() = 0.008 * nod;
  if (frame == 0) { // exactly the origin, whatever is left of rounding
    pose.linear() = worldFromCamera();
    pose.translation().setZero();
  }
  return pose;
}

Eigen::Isometry3d
SyntheticScene::kittiPose(int frame) const
{
  return pose(0).inverse() * pose(frame);
}

SyntheticHit
SyntheticScene::intersect(const Eigen::Vector3d& origin,
                          const Eigen::Vector3d& direction) const
{
  SyntheticHit hit;
  synthetic::Surface surface;
  if (!street_->nearest({origin, direction}, surface)) {
    hit.distance = std::numeric_limits<double>::infinity();
    return hit;
  }
  hit.label = surface.label;
  hit.distance = surface.distance;
  hit.point = surface.point;
  return hit;
}

} // namespace pcl_semantic
