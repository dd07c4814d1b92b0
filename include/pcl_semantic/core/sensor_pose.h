// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/export.h>

#include <Eigen/Geometry>
#include <pcl/point_cloud.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The rotation from KITTI's first frame of camera 0 (x right, y down, z
 * forward) to the world frame (x forward, y left, z up). Both have their origin at the
 * first pose. */
inline Eigen::Isometry3d
worldFromFirstCamera()
{
  Eigen::Isometry3d T_world_first = Eigen::Isometry3d::Identity();
  T_world_first.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return T_world_first;
}

/** \brief The pose of a cloud, which PCL reads from VIEWPOINT: T_world_sensor for
 * SemanticVoxelMap::integrate() if its points are in the sensor's frame.
 * \throws BadInputException if its quaternion is 0 0 0 0 */
template <typename PointT>
Eigen::Isometry3d
sensorPose(const pcl::PointCloud<PointT>& cloud)
{
  if (!(cloud.sensor_orientation_.norm() > 1e-6f))
    throw BadInputException("the cloud has the quaternion 0 0 0 0 in its "
                            "sensor_orientation_, expected w x y z of length 1");
  return Eigen::Translation3d(
             cloud.sensor_origin_.template head<3>().template cast<double>()) *
         cloud.sensor_orientation_.template cast<double>().normalized();
}

/** \brief Requires a rotation and a translation. The last row must be 0 0 0 1 to 1e-6;
 * a transposed matrix (OpenGL, ARCore) or one read from 12 numbers fails here. The
 * rotation may be off by 1e-3, because text files have few digits.
 * \param[in] name of the pose, for the message: "the pose of the sensor"
 * \throws BadInputException that names the pose, if it is not rigid */
void requireRigid(const Eigen::Isometry3d& pose, const std::string& name);

} // namespace pcl_semantic
