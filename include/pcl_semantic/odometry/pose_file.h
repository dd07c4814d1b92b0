// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/odometry/pose_source.h>

#include <memory>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The poses of a trajectory file, KITTI's or TUM's, whichever it is.
 * \param[in] T_camera0_camera the camera that takes the images, in camera 0, whose
 * poses the file holds \throws BadInputException as readKittiTrajectory() and
 * readTumTrajectory() */
std::unique_ptr<PoseSource>
readPoses(const std::string& path,
          const Eigen::Isometry3d& T_camera0_camera = Eigen::Isometry3d::Identity());

/** \brief The same of a file that holds the poses of the sensor itself, T_world_sensor
 * in a world with z up (x forward, if the map shall be seen as it was driven). */
std::unique_ptr<PoseSource> readSensorPoses(const std::string& path);

} // namespace pcl_semantic
