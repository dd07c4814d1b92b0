// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/pipeline/mapper_config.h>
#include <pcl_semantic/superpixels/superpixel_cliques.h>

#include <Eigen/Geometry>
#include <pcl/PointIndices.h>

#include <memory>
#include <vector>

namespace pcl_semantic {

/** \brief Makes the cliques of a map's voxels according to a MapperConfig. */
class MapCliques {
public:
  /** \throws InvalidParameterException at invalid cliques */
  explicit MapCliques(const MapperConfig& config);

  /** \brief Sets the frame of the next voxels, for superpixels.
   * \param[in] cloud organized, camera frame [m]; not copied
   * \param[in] T_world_camera its pose */
  void setFrame(const pcl::PointCloud<pcl::PointXYZRGB>::ConstPtr& cloud,
                const Eigen::Isometry3d& T_world_camera);

  /** \brief Groups voxels. */
  std::vector<pcl::PointIndices> generate(const VoxelCloud& voxels);

private:
  CliqueGenerator::Ptr generator_;
  std::vector<std::shared_ptr<SuperpixelCliques>> superpixels_; // of generator_
};

} // namespace pcl_semantic
