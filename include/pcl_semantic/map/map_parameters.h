// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief How the pixels of one scan that hit the same voxel are taken together. */
enum class PixelFusion {
  mean,   ///< mean log-likelihood: one witness a scan
  product ///< every pixel is a witness of its own (eq. (1) of the paper, word by word)
};

/** \brief Which part of the ray to a point clears space. */
enum class Clearing {
  none,   ///< no part: what was hit once stays occupied
  full,   ///< all of it up to the voxel of the point (as in the paper)
  careful ///< all but the end, where it may run along the surface that it meets
};

/** \brief Parameters of occupancy, colour and label fusion. */
struct FusionParameters {
  double hit_probability = 0.7;      ///< of being occupied, given a hit
  double miss_probability = 0.4;     ///< of being occupied, given a ray through it
  double min_probability = 0.03;     ///< clamp of occupancy from below
  double max_probability = 0.97;     ///< clamp of occupancy from above
  double occupied_probability = 0.5; ///< occupied at or above; one hit is enough
  Clearing clearing = Clearing::careful;
  PixelFusion pixel_fusion = PixelFusion::mean;
  double label_min_probability = 0.01; ///< clamp of each measurement from below
  /// Every ray through a voxel is a miss and every end in it a hit, one after the other
  /// (as in the paper), instead of one update a scan: the order of the points matters.
  bool per_ray_counting = false;
  /// Log-odds that occupied voxels of dynamic classes lose at each scan, so that what
  /// has moved on leaves no trail where no ray clears it; 0 = none.
  double dynamic_decay = 0.0;
  double label_max_ratio = 1e4; ///< clamp of a fused distribution: largest / smallest

  /** \throws InvalidParameterException */
  void validate() const;
};

/** \brief Parameters of SemanticVoxelMap. */
struct MapParameters {
  double voxel_size = 0.1; ///< edge of a voxel [m]
  /// Extent of the window around the sensor, world axes [m], rounded up to blocks;
  /// zeros: see withWindow().
  Eigen::Vector3d window{0.0, 0.0, 0.0};
  /// Reach in each axis of the sensor's frame [m]; for a camera with less than 90
  /// degrees of view this is depth. Points beyond it clear space up to it.
  double max_range = 40.0;
  FusionParameters fusion;

  /** \brief The same with an extent in the place of zeros: max_range along each axis
   * and 2 m more, at most 204 x 204 x 24 m. */
  MapParameters withWindow() const;

  /** \throws InvalidParameterException */
  void validate() const;
};

} // namespace pcl_semantic
