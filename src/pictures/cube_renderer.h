// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/core/voxel_index.h>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include <vector>

namespace pcl_semantic {

/** \brief The visible voxel of each pixel and its depth. */
struct CubeImage {
  cv::Mat voxel; ///< CV_32SC1, index in the list of voxels; -1 = none
  cv::Mat depth; ///< CV_64FC1, camera z of the surface [m]; 0 = no voxel
};

/** \brief Renders voxels as solid cubes, the nearest along the ray of each pixel
 * centre, without a graphics card.
 *
 * A cube covers [index, index + 1) times the voxel size in the world frame. The result
 * depends neither on the number of threads nor on the order of the voxels, with one
 * exception: if two cubes touch exactly on a ray, the first in the list wins.
 * Computations are relative to the camera in double precision, so accuracy does not
 * depend on the distance from the origin.
 *
 * A cube with a corner nearer than z = 0.1 m is ignored: it would cover the image, and
 * it is noise or part of the vehicle.
 * \param[in] voxels each once, fewer than 2^31
 * \param[in] voxel_size edge of a voxel [m]
 * \param[in] camera pinhole with its image size
 * \param[in] T_world_camera pose of the camera (x right, y down, z forward)
 * \param[in] max_depth largest camera z of a rendered face [m]; may be
 * infinite
 * \return images of height x width
 * \throws InvalidParameterException unless voxel size, image size and \a max_depth are
 * positive */
CubeImage renderCubes(const std::vector<VoxelIndex>& voxels, double voxel_size,
                      const StereoCamera& camera,
                      const Eigen::Isometry3d& T_world_camera, double max_depth);

} // namespace pcl_semantic
