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
 * Stereo makes things wider than they are: pixels beside a pole get the depth of the
 * pole. A hit wins over a miss in a map, so that a few such pixels fill a whole voxel.
 * Here a voxel keeps its points if they are a fraction of those pixels that see it or
 * look past it, of the rectangle that encloses its cube in the image. A pixel looks
 * past if its depth is larger than that of the voxel's centre by more than 0.5 m and
 * what a ray over the edge of a voxel of the ground gains when the camera is 2 m high,
 * z voxel_size / 2 m. One without depth says nothing.
 *
 * \param[in,out] cloud of the image, camera frame [m]; erased points become NaN
 * \param[in] camera its image size is that of the cloud
 * \param[in] voxel_size edge of a voxel [m]
 * \param[in] fraction 0 to 1; 0 = nothing is erased
 * \return number of points erased; it and they do not depend on the number of threads
 * \throws InvalidParameterException if the cloud is not the camera's, or a parameter is
 * out of its range
 * \throws BadInputException as requireRigid() */
std::size_t eraseSeenThrough(pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                             const StereoCamera& camera,
                             const Eigen::Isometry3d& T_world_camera, double voxel_size,
                             double fraction);

} // namespace pcl_semantic
