// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/map/semantic_voxel_map.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Finds the occupied voxels at points, with the voxel boundaries that scans
 * use. */
class VoxelLookup {
public:
  /** \brief Index for "no voxel". */
  static constexpr std::int32_t none = -1;

  /** \param[in] voxels indices and voxel size are copied */
  explicit VoxelLookup(const VoxelCloud& voxels);

  /** \brief The voxel that contains a point.
   * \param[in] point world frame [m]
   * \return its index in the cloud, or none */
  std::int32_t at(const Eigen::Vector3d& point) const;

  /** \brief The voxel whose cube is nearest to a point: at() if there is one; in a tie,
   * the first by z, y, x.
   * \param[in] within largest distance to the cube [m]; 0 = only the voxel that
   * contains the point
   * \return its index in the cloud, or none */
  std::int32_t nearest(const Eigen::Vector3d& point, double within) const;

  /** \brief nearest() of many points. */
  std::vector<std::int32_t> indices(const std::vector<Eigen::Vector3d>& points,
                                    double within = 0.0) const;

  /** \brief Index in the cloud of the voxel with a grid index, or none. */
  std::int32_t find(const VoxelIndex& index) const;

private:
  void nearestInBlock(const Eigen::Vector3d& point, const VoxelIndex& first,
                      const VoxelIndex& last, double& least, VoxelIndex& best) const;

  std::unordered_map<VoxelIndex, std::int32_t, VoxelIndexHash> indices_;
  std::unordered_set<VoxelIndex, VoxelIndexHash> blocks_; // blocks with a voxel
  double voxel_size_;
};

/** \brief The labels of a map at one time, by index in its cloud: before the CRF (fused
 * measurements only) and after. */
struct MapLabels {
  explicit MapLabels(const VoxelCloud& voxels);

  VoxelLookup lookup;
  std::vector<Label> measured;
  std::vector<Label> refined;
};

/** \brief The label of each index; kUnlabelled for VoxelLookup::none. */
std::vector<Label> labelsAt(const std::vector<std::int32_t>& indices,
                            const std::vector<Label>& labels);

/** \brief The same for an image of indices.
 * \param[in] indices CV_32SC1
 * \return CV_8UC1 */
cv::Mat labelsAt(const cv::Mat& indices, const std::vector<Label>& labels);

/** \brief Depth lookup: the label of the voxel that contains each pixel's own measured
 * point. The paper's released code evaluates this way; compare only these scores with
 * the paper's.
 * \param[in] map queried in its current state
 * \param[in] cloud organized cloud of the frame, camera frame [m]; NaN = no depth
 * \param[in] T_world_camera pose of the frame
 * \param[in] max_depth points with a larger z are not looked up [m]
 * \return CV_8UC1 of the cloud's size; 0 = no depth, or no occupied voxel there
 * \throws InvalidParameterException if the cloud is not organized
 * \throws BadInputException as requireRigid() */
cv::Mat labelsAtDepth(const SemanticVoxelMap& map,
                      const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                      const Eigen::Isometry3d& T_world_camera, double max_depth);

/** \brief A map rendered from a camera. */
struct RenderedLabels {
  cv::Mat labels;  ///< CV_8UC1; 0 = no voxel, or an unlabelled one
  cv::Mat depth;   ///< CV_32FC1, camera z of the surface [m]; 0 = no voxel
  cv::Mat indices; ///< CV_32SC1, index of the voxel in the cloud; -1 = none
};

/** \brief Renders voxels as solid cubes, the nearest along the ray of each pixel
 * centre.
 *
 * A cube covers [index, index + 1) times the voxel size in the world frame. A face
 * without a neighbour is drawn 0.2 voxels from the voxel's point, inside its cube,
 * because whole cubes are thicker than the surfaces they represent. The colour of a
 * cube is the label of its point in the cloud. The result depends neither on the number
 * of threads nor on the order of the voxels, with one exception: if two cubes touch
 * exactly on a ray, the first in the cloud wins.
 *
 * A cube with a corner nearer than z = 0.1 m is ignored: it would cover the image, and
 * it is noise or part of the vehicle.
 * \param[in] voxels points, indices, voxel size and the labels of the cloud are used
 * \param[in] camera pinhole with its image size
 * \param[in] T_world_camera pose of the camera (x right, y down, z forward)
 * \param[in] max_depth largest camera z of a rendered surface point [m]; may be
 * infinite
 * \return images of height x width
 * \throws InvalidParameterException unless cloud and indices have the same length and
 * voxel size, image size and \a max_depth are positive
 * \throws BadInputException as requireRigid() */
RenderedLabels renderLabels(const VoxelCloud& voxels, const StereoCamera& camera,
                            const Eigen::Isometry3d& T_world_camera, double max_depth);

} // namespace pcl_semantic
