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
 * 8 x 8 x 8 by z, y, x, and the voxels of a block in the same order.
 *
 * All arrays have one entry per voxel. A point is the mean position of the hits in its
 * voxel, relative to \a origin, world axes [m]. */
struct VoxelCloud {
  pcl::PointCloud<pcl::PointXYZRGBL>::Ptr cloud{
      new pcl::PointCloud<pcl::PointXYZRGBL>}; ///< position, mean colour, MAP label
  LabelDistributions measured;                 ///< fused measurements, without a CRF
  LabelDistributions refined; ///< the CRF's result, or the measurements if there is
                              ///< none: the distributions to use
  std::vector<std::uint8_t> is_refined;    ///< whether \a refined comes from the CRF;
                                           ///< empty: unknown
  std::vector<VoxelIndex> indices;         ///< global voxel indices
  std::vector<std::uint32_t> observations; ///< scans that hit the voxel
  std::vector<std::uint32_t> objects;      ///< number of the voxel's object, 0 = none;
                                           ///< empty: unknown
  std::vector<std::uint32_t> planes;       ///< number of the voxel's plane, 0 = none;
                                           ///< empty: unknown
  double voxel_size = 0.0;                 ///< edge of a voxel [m]
  Eigen::Vector3d origin = Eigen::Vector3d::Zero(); ///< of the points, world frame [m]

  std::size_t
  size() const
  {
    return indices.size();
  }

  /** \brief Centre of a voxel, relative to \a origin, world axes [m]. */
  Eigen::Vector3f
  centre(std::size_t i) const
  {
    return (centreOf(indices[i], voxel_size) - origin).cast<float>();
  }

  /** \brief Moves all points to the centres of their voxels. */
  void
  moveToCentres()
  {
    for (std::size_t i = 0; i < size(); ++i)
      (*cloud)[i].getVector3fMap() = centre(i);
  }
};

/** \brief Whether any voxel has a measured colour; voxels of a scanner have none. */
bool hasColour(const VoxelCloud& voxels);

} // namespace pcl_semantic
