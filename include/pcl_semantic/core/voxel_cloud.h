// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/voxel_index.h>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cstdint>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Occupied voxels as a labelled cloud, in the map's canonical order: blocks of
 * 8 x 8 x 8 by z, y, x, and their voxels likewise.
 *
 * All arrays have one entry a voxel. A point is the centre of its voxel relative to
 * \a origin, world axes [m]; its exact position is its index. */
struct VoxelCloud {
  pcl::PointCloud<pcl::PointXYZRGBL>::Ptr cloud{
      new pcl::PointCloud<pcl::PointXYZRGBL>}; ///< centre, mean colour, MAP label
  LabelDistributions measured;                 ///< fused measurements alone
  LabelDistributions refined;      ///< what a reader should use: the CRF's result where
                                   ///< there is one, else the measurements
  std::vector<VoxelIndex> indices; ///< global voxel indices
  std::vector<std::uint32_t> observations;          ///< scans that hit the voxel
  double voxel_size = 0.0;                          ///< edge of a voxel [m]
  Eigen::Vector3d origin = Eigen::Vector3d::Zero(); ///< of the points, world frame [m]

  std::size_t
  size() const
  {
    return indices.size();
  }
};

} // namespace pcl_semantic
