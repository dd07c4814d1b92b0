/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/core/label_distributions.h>

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief What the map needs of a cloud of any type. */
struct Scan {
  std::vector<Eigen::Vector3f> points; ///< sensor frame [m]
  std::vector<std::uint32_t> rgb;      ///< packed as in PCL; empty = no colour
  const LabelDistributions* distributions = nullptr; ///< null = no labels
  /// Standard deviation of the distance along each ray [m]; null = exact.
  const std::vector<float>* deviations = nullptr;
};

/** \brief Counts of one scan. */
struct ScanCounts {
  std::size_t points = 0;     ///< in the cloud
  std::size_t rays = 0;       ///< cast
  std::size_t invalid = 0;    ///< at NaN, infinite or absurdly far: skipped
  std::size_t sky = 0;        ///< labelled as sky: skipped
  std::size_t hit_voxels = 0; ///< voxels with an end point
};

} // namespace pcl_semantic
