// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/core/voxel_cloud.h>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A map as the camera sees it. */
struct RenderedLabels {
  cv::Mat labels; ///< CV_8UC1; 0 = no voxel, or an unlabelled one
  cv::Mat depth;  ///< CV_32FC1, camera z of the surface [m]; 0 = no voxel
  cv::Mat places; ///< CV_32SC1, which voxel of the cloud; -1 = none
};

/** \brief Renders voxels as solid cubes of their own size, the nearest along the ray of
 * each pixel centre.
 *
 * A cube covers [index, index + 1) times the voxel size in the world frame and is drawn
 * in the label of its point in the cloud. The result does not depend on the number of
 * threads nor on the order of the voxels, but where two cubes touch exactly on a ray,
 * the first in the cloud is seen.
 *
 * A cube with a corner nearer than z = 0.1 m is passed over: it would cover the picture
 * and is the camera's own car or noise.
 * \param[in] voxels indices, voxel size and the labels of the cloud are used
 * \param[in] camera pinhole with its image size
 * \param[in] T_world_camera pose of the camera (x right, y down, z forward)
 * \param[in] max_depth surface points of larger camera z are not seen [m]; may be
 * infinite
 * \return images of height x width
 * \throws InvalidParameterException unless cloud and indices have the same length and
 * voxel size, image size and \a max_depth are positive */
RenderedLabels renderLabels(const VoxelCloud& voxels, const StereoCamera& camera,
                            const Eigen::Isometry3d& T_world_camera, double max_depth);

} // namespace pcl_semantic
