// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/point_types.h>
#include <pcl/segmentation/supervoxel_clustering.h>

// Implementation of PCL's templates.
#include <pcl/segmentation/impl/supervoxel_clustering.hpp>

#include <cstdint>

namespace pcl_semantic {

/** \brief PCL's supervoxels for a point type that libpcl_segmentation does not
 * instantiate. Compiling them here avoids linking it: 40 MB and 12 further libraries.
 * PCL leaves the sums of a voxel to specializations, which follow. */
using SupervoxelPoint = pcl::PointXYZRGBL;
using SupervoxelClustering = pcl::SupervoxelClustering<SupervoxelPoint>;
using SupervoxelLeaf =
    pcl::octree::OctreePointCloudAdjacencyContainer<SupervoxelPoint,
                                                    SupervoxelClustering::VoxelData>;

} // namespace pcl_semantic

namespace pcl {

template <>
inline void
octree::OctreePointCloudAdjacencyContainer<
    pcl_semantic::SupervoxelPoint, pcl_semantic::SupervoxelClustering::VoxelData>::
    addPoint(const pcl_semantic::SupervoxelPoint& point)
{
  data_.xyz_ += point.getVector3fMap();
  data_.rgb_ += point.getRGBVector3i().cast<float>();
  ++num_points_;
}

template <>
inline void
octree::OctreePointCloudAdjacencyContainer<
    pcl_semantic::SupervoxelPoint,
    pcl_semantic::SupervoxelClustering::VoxelData>::computeData()
{
  const auto count = static_cast<float>(num_points_);
  data_.xyz_ /= count;
  data_.rgb_ /= count;
}

template <>
inline void
SupervoxelClustering<pcl_semantic::SupervoxelPoint>::VoxelData::getPoint(
    pcl_semantic::SupervoxelPoint& point) const
{
  point.getVector3fMap() = xyz_;
  point.r = static_cast<std::uint8_t>(rgb_[0]);
  point.g = static_cast<std::uint8_t>(rgb_[1]);
  point.b = static_cast<std::uint8_t>(rgb_[2]);
}

} // namespace pcl
