// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/core/voxel_cloud.h>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

namespace pcl_semantic {

/** \brief The class and the visible voxel of each pixel. */
struct SplatImage {
  cv::Mat label; ///< CV_8UC1; 0 = no voxel, or an unlabelled one
  cv::Mat voxel; ///< CV_32SC1, index in the cloud; -1 = none
  cv::Mat depth; ///< CV_32FC1, camera z of the voxel's point [m]; 0 = no voxel
};

/** \brief Renders the points of voxels as soft splats, and lets classes vote.
 *
 * A splat has the opacity n^2 / (n^2 + 2) in its middle, where n is the number of
 * scans that hit the voxel. At a distance d from the ray of a pixel centre, its opacity
 * falls by (1 - d^2 / r^2)^5, r = 0.87 voxels. Splats are blended front to back, up to
 * 1 m behind the first one with an opacity above 0.05 (all if there is none). The class
 * with the largest sum of weights wins, and of its voxels the one with the largest
 * weight. Unlabelled voxels win only if there are no others. See doc/map.md, "Rendered
 * views".
 *
 * The result depends neither on the number of threads nor on the order of the voxels.
 * Computations are relative to the camera, so accuracy does not depend on the distance
 * from the origin. A splat that reaches nearer than z = 0.1 m is ignored.
 * \param[in] voxels points, observations (empty = one each), voxel size and the labels
 * of the cloud are used; fewer than 2^31
 * \param[in] camera pinhole with its image size
 * \param[in] T_world_camera pose of the camera (x right, y down, z forward)
 * \param[in] max_depth largest camera z of a point [m]; may be infinite
 * \return images of height x width
 * \throws InvalidParameterException unless voxel size, image size and \a max_depth are
 * positive
 * \throws BadInputException if a label is above 255 */
SplatImage renderSplats(const VoxelCloud& voxels, const StereoCamera& camera,
                        const Eigen::Isometry3d& T_world_camera, double max_depth);

} // namespace pcl_semantic
