// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/map/voxel_fusion.h>

#include <Eigen/Core>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Parameters of SemanticVoxelMap. */
struct MapParameters {
  double voxel_size = 0.1; ///< edge of a voxel [m]
  /// Extent of the window around the sensor, world axes [m], rounded up to blocks.
  Eigen::Vector3d window{84.0, 84.0, 24.0};
  /// Reach in each axis of the sensor's frame [m]; for a camera with less than 90
  /// degrees of view this is depth. Points beyond it clear space up to it.
  double max_range = 40.0;
  FusionParameters fusion;

  /** \throws InvalidParameterException */
  void validate() const;
};

} // namespace pcl_semantic
