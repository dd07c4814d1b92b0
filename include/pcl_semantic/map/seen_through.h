// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>

#include <Eigen/Geometry>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cstddef>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Erases the points of voxels that most rays of the same image pass through.
 *
 * Stereo causes foreground fattening: pixels beside a pole get the depth of the pole. A
 * hit wins over a miss in a map, so a few such pixels fill a whole voxel. This filter
 * counts the pixels in the rectangle around a voxel's projected cube: those that hit
 * the voxel and those that see through it. A voxel keeps its points if hits are at
 * least a fraction of this count. A pixel sees through a voxel if its depth exceeds
 * that of the voxel's centre by more than 0.5 m plus z voxel_size / 2 m, the depth
 * range of a ray over the edge of a ground voxel for a camera 2 m above ground. Pixels
 * without depth are not counted.
 *
 * \param[in,out] cloud of the image, camera frame [m]; erased points become NaN
 * \param[in] camera its image size is that of the cloud
 * \param[in] voxel_size edge of a voxel [m]
 * \param[in] fraction 0 to 1; 0 = nothing is erased
 * \return number of erased points; the result does not depend on the number of threads
 * \throws InvalidParameterException if the cloud is not of the camera's image size, or
 * a parameter is out of range
 * \throws BadInputException as requireRigid() */
std::size_t eraseSeenThrough(pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                             const StereoCamera& camera,
                             const Eigen::Isometry3d& T_world_camera, double voxel_size,
                             double fraction);

} // namespace pcl_semantic
