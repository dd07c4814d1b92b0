// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/io/voxel_scene.h>

#include <Eigen/Geometry>
#include <opencv2/core/types.hpp>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief From where a picture of a scene is taken. Its world is that of the scene's
 * indices: cube 0 begins at the origin, z is up. */
struct SceneView {
  StereoCamera camera; ///< its baseline means nothing
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  double pixels_per_metre = 0.0; ///< everywhere in the picture; 0 = it has depth
};

/** \brief Positions of a sensor, in the world of a view [m]. */
using SensorPath = std::vector<Eigen::Vector3d>;

/** \brief A camera at \a from that looks at \a target, upright.
 * \param[in] field_of_view angle over the width [rad]
 * \throws InvalidParameterException if they are one point, or an angle or a size cannot
 * be */
SceneView lookAt(const Eigen::Vector3d& from, const Eigen::Vector3d& target,
                 double field_of_view, cv::Size size);

/** \brief The view along the path from behind and above, near enough that the map fills
 * the picture: all but its last few percent on every side, where the stray voxels are.
 * Without a path it looks along the longer side. */
SceneView angleView(const VoxelScene& scene, const SensorPath& path, cv::Size size);

/** \brief Straight from above, without perspective, the path from left to right. */
SceneView aboveView(const VoxelScene& scene, const SensorPath& path, cv::Size size);

} // namespace pcl_semantic
