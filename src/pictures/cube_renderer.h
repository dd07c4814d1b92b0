// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/core/voxel_index.h>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include <vector>

namespace pcl_semantic {

/** \brief Which voxel each pixel sees, and how far away it is. */
struct CubeImage {
  cv::Mat voxel; ///< CV_32SC1, offset in the list of voxels; -1 = none
  cv::Mat depth; ///< CV_64FC1, camera z of the surface [m]; 0 = no voxel
};

/** \brief Renders voxels as solid cubes of their own size, the nearest along the ray of
 * each pixel centre, without a graphics card.
 *
 * A cube covers [index, index + 1) times the voxel size in the world frame. The result
 * does not depend on the number of threads nor on the order of the voxels, but where
 * two cubes touch exactly on a ray, the first in the list is seen. All is computed
 * relative to the camera in double precision: nothing is lost far from the origin.
 *
 * A cube with a corner nearer than z = 0.1 m is passed over: it would cover the picture
 * and is the camera's own car or noise.
 * \param[in] voxels each once, fewer than 2^31
 * \param[in] voxel_size edge of a voxel [m]
 * \param[in] camera pinhole with its image size
 * \param[in] T_world_camera pose of the camera (x right, y down, z forward)
 * \param[in] max_depth surface points of larger camera z are not seen [m]; may be
 * infinite
 * \param[in] surface where the surface lies in each voxel, 0..1 along each axis, or
 * empty for whole cubes. A face with no voxel on its other side is drawn 0.3 voxels
 * from there, inside its cube: whole cubes are fatter than what they stand for \return
 * images of height x width \throws InvalidParameterException unless voxel size, image
 * size and \a max_depth are positive, and \a surface is empty or has one entry a voxel
 */
CubeImage renderCubes(const std::vector<VoxelIndex>& voxels, double voxel_size,
                      const StereoCamera& camera,
                      const Eigen::Isometry3d& T_world_camera, double max_depth,
                      const std::vector<Eigen::Array3f>& surface = {});

} // namespace pcl_semantic
