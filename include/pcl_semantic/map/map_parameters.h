// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Combination of the pixels of one scan that hit the same voxel. */
enum class PixelFusion {
  mean,   ///< mean log-likelihood: one measurement per scan
  product ///< every pixel is an independent measurement (eq. (1) of the paper,
          ///< literally)
};

/** \brief The part of a ray that clears space. */
enum class Clearing {
  none,   ///< none: voxels that were hit once stay occupied
  full,   ///< all voxels before that of the point (as in the paper)
  careful ///< all but the end, where a ray may graze the surface that it hits
};

/** \brief Parameters of occupancy, colour and label fusion. */
struct FusionParameters {
  double hit_probability = 0.7; ///< probability of being occupied, given a hit
  double miss_probability =
      0.4; ///< probability of being occupied, given a ray through it
  double min_probability = 0.03;     ///< lower clamp of occupancy
  double max_probability = 0.97;     ///< upper clamp of occupancy
  double occupied_probability = 0.5; ///< occupied at or above; one hit is enough
  Clearing clearing = Clearing::careful;
  PixelFusion pixel_fusion = PixelFusion::mean;
  double label_min_probability = 0.01; ///< lower clamp of each measurement
  /// Counts every ray through a voxel as a miss and every end in it as a hit, one by
  /// one (as in the paper), instead of one update per scan. The result then depends on
  /// the order of the points.
  bool per_ray_counting = false;
  /// Frees the voxels of dynamic classes that scans see past, see doc/map.md.
  bool free_dynamic = true;
  /// A hit whose label is a dynamic class makes a free voxel occupied at once, because
  /// an object may have arrived. Only with an ObjectTracker, which finds out where it
  /// was: without one, moving objects leave longer trails.
  bool occupy_dynamic = false;
  /// Weighs the labels of each scan by the precision of its depths, relative to the
  /// best look at the voxel: a near look counts more than a far one. Only for scans
  /// with a depth error, see SemanticVoxelMap::setDepthError().
  bool weigh_labels = true;
  double label_max_ratio = 1e4; ///< clamp of a fused distribution: largest / smallest

  /** \throws InvalidParameterException that names the parameter and its range */
  void validate() const;
};

struct MapParameters {
  double voxel_size = 0.1; ///< edge of a voxel [m]
  /// Extent of the window around the sensor, world axes [m], rounded up to blocks;
  /// zeros: see withWindow().
  Eigen::Vector3d window{0.0, 0.0, 0.0};
  /// Maximum distance along each axis of the sensor's frame [m]; for a camera with less
  /// than 90 degrees of view this is depth. Rays to farther points clear space up to
  /// it.
  double max_range = 40.0;
  FusionParameters fusion;

  /** \brief The same with zeros of the window replaced: max_range plus 2 m along each
   * axis, at most 204 x 204 x 24 m. */
  MapParameters withWindow() const;

  /** \throws InvalidParameterException that names the parameter and its range */
  void validate() const;
};

} // namespace pcl_semantic
