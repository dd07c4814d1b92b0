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

/** \brief Finds the occupied voxels at points. A point lies in the same voxel as in
 * SemanticVoxelMap::integrate(). */
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

  /** \brief The voxel whose cube is nearest to a point. In a tie, it is the first voxel
   * in the order z, y, x.
   * \param[in] point world frame [m]
   * \param[in] within largest distance to the cube [m]; 0 = only the voxel that
   * contains the point
   * \return its index in the cloud, or none */
  std::int32_t nearest(const Eigen::Vector3d& point, double within) const;

  /** \brief Calls nearest() for many points, in parallel.
   * \return one index per point */
  std::vector<std::int32_t> indices(const std::vector<Eigen::Vector3d>& points,
                                    double within = 0.0) const;

  /** \brief The voxel with a global index, see VoxelCloud::indices.
   * \return its index in the cloud, or none */
  std::int32_t find(const VoxelIndex& index) const;

private:
  void nearestInBlock(const Eigen::Vector3d& point, const VoxelIndex& first,
                      const VoxelIndex& last, double& least, VoxelIndex& best) const;

  std::unordered_map<VoxelIndex, std::int32_t, VoxelIndexHash> indices_;
  std::unordered_set<VoxelIndex, VoxelIndexHash> blocks_; // blocks with a voxel
  double voxel_size_;
};

/** \brief The labels of the voxels of a cloud, before the CRF (fused measurements) and
 * after it. */
struct MapLabels {
  /** \throws BadInputException if a label is above 255 */
  explicit MapLabels(const VoxelCloud& voxels);

  VoxelLookup lookup;
  std::vector<Label> measured;        ///< by index in the cloud
  std::vector<Label> refined;         ///< by index in the cloud
  std::vector<std::uint32_t> objects; ///< VoxelCloud::objects
};

/** \brief Converts indices of voxels to labels. VoxelLookup::none becomes kUnlabelled.
 * \param[in] labels by index in the cloud */
std::vector<Label> labelsAt(const std::vector<std::int32_t>& indices,
                            const std::vector<Label>& labels);

/** \brief Converts an image of voxel indices to labels. VoxelLookup::none becomes
 * kUnlabelled.
 * \param[in] indices CV_32SC1
 * \param[in] labels by index in the cloud
 * \return CV_8UC1 */
cv::Mat labelsAt(const cv::Mat& indices, const std::vector<Label>& labels);

/** \brief Looks up labels at the depth of a frame: a pixel gets the label of the voxel
 * that contains its measured point.
 *
 * The paper's released code evaluates this way. Other scores cannot be compared with
 * the paper's.
 * \param[in] map only its window is searched
 * \param[in] cloud organized cloud of the frame, camera frame [m]; NaN = no depth
 * \param[in] T_world_camera pose of the frame
 * \param[in] max_depth largest z of a point to look up [m]
 * \return CV_8UC1 of the cloud's size; 0 = no depth, a depth beyond \a max_depth, or no
 * labelled voxel there
 * \throws InvalidParameterException if the cloud is not organized
 * \throws BadInputException if the pose is not rigid */
cv::Mat labelsAtDepth(const SemanticVoxelMap& map,
                      const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                      const Eigen::Isometry3d& T_world_camera, double max_depth);

/** \brief A map rendered from a camera. */
struct RenderedLabels {
  cv::Mat labels;  ///< CV_8UC1; 0 = no voxel, or an unlabelled one
  cv::Mat depth;   ///< CV_32FC1, camera z of the surface [m]; 0 = no voxel
  cv::Mat indices; ///< CV_32SC1, index of the voxel in the cloud; -1 = none
};

/** \brief Renders the points of voxels as soft splats, up to 1 m behind the first one
 * of a pixel's ray, and gives the pixel the class with the largest weight (doc/map.md,
 * "Rendered views").
 *
 * A splat has the opacity n^2 / (n^2 + 2) in its middle, where n is the number of scans
 * that hit the voxel, and ends at 0.87 voxels. Unlabelled voxels show only where there
 * are no others. The result depends neither on the number of threads nor on the order
 * of the voxels. Voxels nearer than z = 0.1 m are ignored: they are noise or part of
 * the vehicle.
 *
 * \param[in] voxels points, observations, voxel size and labels of the cloud are used
 * \param[in] camera pinhole with its image size
 * \param[in] T_world_camera pose of the camera (x right, y down, z forward)
 * \param[in] max_depth largest camera z of a point [m]; may be infinite
 * \return images of height x width
 * \throws InvalidParameterException if cloud and indices differ in length, or if voxel
 * size, image size or \a max_depth is not positive
 * \throws BadInputException if the pose is not rigid, or a label is above 255 */
RenderedLabels renderLabels(const VoxelCloud& voxels, const StereoCamera& camera,
                            const Eigen::Isometry3d& T_world_camera, double max_depth);

} // namespace pcl_semantic
