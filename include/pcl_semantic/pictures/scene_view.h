// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/io/voxel_scene.h>

#include <Eigen/Geometry>
#include <opencv2/core/types.hpp>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Camera of a rendered scene. Its world frame is that of the scene's indices:
 * voxel 0 begins at the origin, z is up. */
struct SceneView {
  StereoCamera camera; ///< its baseline is ignored
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  double pixels_per_metre = 0.0; ///< scale of an orthographic view; 0 = perspective
};

/** \brief Positions of a sensor, in the world frame of a view [m]. */
using SensorPath = std::vector<Eigen::Vector3d>;

/** \brief Places an upright camera at \a from that looks at \a target.
 * \param[in] field_of_view horizontal angle [rad]
 * \throws InvalidParameterException if both are one point, or an angle or a size is
 * invalid */
SceneView lookAt(const Eigen::Vector3d& from, const Eigen::Vector3d& target,
                 double field_of_view, cv::Size size);

/** \brief The view along the path from behind and above, at a distance at which the map
 * fills the image. The outermost few percent of the voxels on every side are often
 * stray and may be cut off. Without a path it looks along the longer side. */
SceneView angleView(const VoxelScene& scene, const SensorPath& path, cv::Size size);

/** \brief The orthographic view from above, with the path from left to right. */
SceneView aboveView(const VoxelScene& scene, const SensorPath& path, cv::Size size);

} // namespace pcl_semantic
