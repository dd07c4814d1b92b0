// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_cloud.h>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Finds the occupied voxels at points, as scans would hit them. */
class VoxelLookup {
public:
  /** \brief Place of no voxel. */
  static constexpr std::int32_t none = -1;

  /** \param[in] voxels indices and voxel size are kept */
  explicit VoxelLookup(const VoxelCloud& voxels);

  /** \brief The voxel that holds a point.
   * \param[in] point world frame [m]
   * \return its place in the cloud, or none */
  std::int32_t at(const Eigen::Vector3d& point) const;

  /** \brief The voxel whose cube is nearest to a point: at() if there is one; of
   * equally near ones the first by z, y, x. \param[in] within largest distance to the
   * cube [m]; 0 = only the one that holds it \return its place in the cloud, or none */
  std::int32_t nearest(const Eigen::Vector3d& point, double within) const;

  /** \brief nearest() of many points. */
  std::vector<std::int32_t> places(const std::vector<Eigen::Vector3d>& points,
                                   double within = 0.0) const;

  /** \brief Place of the voxel of an index, or none. */
  std::int32_t find(const VoxelIndex& index) const;

  double
  voxelSize() const
  {
    return voxel_size_;
  }

private:
  void nearestInBlock(const Eigen::Vector3d& point, const VoxelIndex& first,
                      const VoxelIndex& last, double& least, VoxelIndex& best) const;

  std::unordered_map<VoxelIndex, std::int32_t, VoxelIndexHash> places_;
  std::unordered_set<VoxelIndex, VoxelIndexHash> blocks_; // that hold a voxel
  double voxel_size_;
};

/** \brief The labels of a map at one moment: before the CRF (the fused measurements
 * alone) and after, by place in its cloud. */
struct MapLabels {
  explicit MapLabels(const VoxelCloud& voxels);

  VoxelLookup lookup;
  std::vector<Label> measured;
  std::vector<Label> refined;
};

/** \brief The label of each place; kUnlabelled for VoxelLookup::none. */
std::vector<Label> labelsAt(const std::vector<std::int32_t>& places,
                            const std::vector<Label>& labels);

/** \brief The same for an image of places.
 * \param[in] places CV_32SC1
 * \return CV_8UC1 */
cv::Mat labelsAt(const cv::Mat& places, const std::vector<Label>& labels);

} // namespace pcl_semantic
